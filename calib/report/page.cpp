#include <fmt/format.h>

#include "calib/report/report.hpp"
#include "protocol/base/xml.hpp"

namespace enamel::calib {
namespace {

constexpr char kStyle[] = R"(
body { font: 15px/1.45 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; color: #1d2733; background: #fbfbf9;
       max-width: 1000px; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.5em; margin-bottom: .2em; }
h2 { font-size: 1.15em; margin: 2em 0 .6em; padding-bottom: .2em; border-bottom: 1px solid #d8dbe0; }
.verdict { display: inline-block; font-size: 1.25em; font-weight: 700; padding: .15em .9em; border-radius: 4px;
           color: #fff; margin: .3em 0; }
.accepted { background: #2e7d4f; }
.refused { background: #b3372a; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
td, th { padding: .22em .9em .22em 0; text-align: left; vertical-align: top; border-bottom: 1px solid #eceef1; }
th { font-weight: 600; color: #5a6875; }
.facts td:first-child { color: #5a6875; }
.notes { color: #5a6875; font-size: .92em; }
.rejected td { color: #b3372a; }
figure { display: inline-block; margin: 0 1.2em 1em 0; vertical-align: top; }
figcaption { color: #5a6875; font-size: .9em; max-width: 460px; }
svg text { font: 12px system-ui, "DejaVu Sans", sans-serif; fill: #3b4754; }
svg text.tick { font-size: 11px; fill: #5a6875; }
svg .field { fill: #fff; stroke: #c9ced4; }
.maps figure { margin-right: .8em; }
.maps figcaption { max-width: 256px; }
img.map { image-rendering: pixelated; border: 1px solid #c9ced4; }
.swatch { display: inline-block; width: .9em; height: .9em; margin-left: .8em; }
)";

}  // namespace

std::string page_of(const std::string& title, const std::vector<ReportSection>& sections) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title><style>{1}</style></head>\n"
      "<body><h1>{0}</h1>\n",
      xml_escaped(title), kStyle);
  for (const ReportSection& s : sections) out += "<h2>" + xml_escaped(s.title) + "</h2>\n" + s.html + "\n";
  return out + "</body></html>\n";
}

}  // namespace enamel::calib
