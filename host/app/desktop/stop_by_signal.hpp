// Ctrl-C brings a table to a stand instead of leaving it to run on without us.
#pragma once

namespace enamel::app {

/// Calls request_stop() of what it was given, from the signal's handler. One at a time, for as long as it lives.
class StopBySignal {
 public:
  template <class Stoppable>
  explicit StopBySignal(Stoppable& what)
      : StopBySignal(&what, [](void* stoppable) { static_cast<Stoppable*>(stoppable)->request_stop(); }) {}
  ~StopBySignal();
  StopBySignal(const StopBySignal&) = delete;
  StopBySignal& operator=(const StopBySignal&) = delete;

 private:
  StopBySignal(void* what, void (*request_stop)(void*));
};

}  // namespace enamel::app
