// A display of its own for one test: Xvfb on a free number, gone with the object.
#pragma once

#include <string>

namespace enamel::view::test {

class Xvfb {
 public:
  Xvfb();
  ~Xvfb();
  Xvfb(const Xvfb&) = delete;
  Xvfb& operator=(const Xvfb&) = delete;

  /// Empty when it runs and DISPLAY names it; else why not.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

 private:
  int pid_ = -1;
  std::string problem_;
};

}  // namespace enamel::view::test
