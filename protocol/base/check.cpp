#include "protocol/base/check.hpp"

#include <cstdio>
#include <cstdlib>

namespace enamel {
namespace {

void print_and_abort(const char* expression, const char* file, int line, std::string_view what) {
  std::fprintf(stderr, "%s:%d: check failed: %s %.*s\n", file, line, expression, static_cast<int>(what.size()),
               what.data());
  std::abort();
}

CheckHandler g_handler = print_and_abort;

}  // namespace

CheckHandler set_check_handler(CheckHandler handler) noexcept {
  const CheckHandler previous = g_handler;
  g_handler = handler != nullptr ? handler : print_and_abort;
  return previous;
}

void check_failed(const char* expression, const char* file, int line, std::string_view what) {
  g_handler(expression, file, line, what);
  std::abort();
}

}  // namespace enamel
