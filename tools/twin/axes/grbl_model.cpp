#include "tools/twin/axes/grbl_model.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <unistd.h>

#include <string_view>
#include <utility>

namespace enamel::twin {
namespace {

constexpr double kHoldS = 0.03;
constexpr double kHomeS = 0.05;
constexpr double kBootS = 0.05;

const std::map<int, double> kUsual{{1, 255},   {10, 1},    {13, 0},    {20, 1},    {22, 1},
                                   {23, 3},    {27, 1},    {32, 0},    {100, 800}, {101, 800},
                                   {102, 250}, {110, 1e5}, {111, 1e5}, {130, 400}, {131, 70}};

}  // namespace

GrblModel::GrblModel(PseudoTerminal terminal, GrblModelSetup setup, Clock& clock)
    : setup_(std::move(setup)),
      clock_(clock),
      terminal_(std::move(terminal)),
      settings_(kUsual),
      random_(setup_.seed, 0, 0) {
  for (const auto& [number, value] : setup_.settings) settings_[number] = value;
  thread_ = std::thread([this] { run(); });
  static_cast<void>(pthread_setname_np(thread_.native_handle(), "sim-grbl"));
}

GrblModel::~GrblModel() {
  ends_ = true;
  thread_.join();
}

void GrblModel::arm(GrblFault fault, double share, int movement) {
  const std::lock_guard lock(mutex_);
  armed_ = fault;
  armed_share_ = share;
  armed_movement_ = movement;
}

std::array<double, 2> GrblModel::position() const {
  const std::lock_guard lock(mutex_);
  return at_;
}

std::pair<std::array<double, 2>, std::array<double, 2>> GrblModel::range() const {
  const std::lock_guard lock(mutex_);
  return {low_, high_};
}

std::array<double, 2> GrblModel::home() const { return {-setting(130) + setting(27), -setting(131) + setting(27)}; }

void GrblModel::tell(HostTime now) const {
  if (!setup_.witness) return;
  const auto zero = home();
  setup_.witness({now, {at_[0] - zero[0], at_[1] - zero[1]}, is_homed_ ? homings_ : 0, moves_});
}

void GrblModel::run() {
  bool was_open = false;
  double boot_s = -1.0;
  HostTime last = clock_.now();
  while (!ends_) {
    // The descriptor is this thread's own: a fault that unplugs it strikes here.
    pollfd p{terminal_.controller(), POLLIN, 0};
    ::poll(&p, p.fd >= 0 ? 1U : 0U, 1);
    const bool is_open = (p.revents & POLLHUP) == 0;
    if (!is_open) clock_.sleep_for(std::chrono::milliseconds(1));
    const std::lock_guard lock(mutex_);
    if (is_open && !was_open && setup_.boots_on_open) boot_s = kBootS;
    was_open = is_open;
    const HostTime now = clock_.now();
    const double dt = std::chrono::duration<double>(now - last).count();
    last = now;
    if (boot_s > 0.0 && (boot_s -= dt) <= 0.0) boot();
    // First up to now, then what is told now: no movement begins before its line.
    step(dt);
    tell(now);
    char buffer[256];
    const ssize_t n = (p.revents & POLLIN) != 0 ? ::read(p.fd, buffer, sizeof(buffer)) : 0;
    for (ssize_t i = 0; i < n && !is_silent_; ++i) take(buffer[i]);
  }
}

void GrblModel::say(std::string line) {
  if (is_silent_ || terminal_.controller() < 0 || setup_.banner.empty()) return;
  if (line == "ok" && lost_oks_ > 0) {
    --lost_oks_;
    return;
  }
  if (bad_lines_ > 0) {
    --bad_lines_;
    // A sign that becomes another of a number makes another number: without a checksum nobody sees that.
    std::size_t at = 0;
    do {
      at = random_.below(static_cast<std::uint32_t>(line.size()));
    } while (std::string_view("-,89").find(line[at]) != std::string_view::npos);
    line[at] = static_cast<char>(line[at] ^ 0x15);
  }
  line += "\r\n";
  // What a closed port does not take is lost, as on a wire.
  static_cast<void>(!::write(terminal_.controller(), line.data(), line.size()));
}

void GrblModel::boot() {
  state_ = State::kAlarm;
  is_homed_ = dwells_ = false;
  is_moving_ = false;
  at_ = {};
  line_.clear();
  say(setup_.banner);
  say("[MSG:'$H'|'$X' to unlock]");
}

void GrblModel::soft_reset() {
  const bool is_lost = state_ == State::kRun || state_ == State::kHome || (state_ == State::kHold && hold_s_ > 0.0);
  if (is_lost) {
    say(state_ == State::kHome ? "ALARM:6" : "ALARM:3");
    is_homed_ = false;
  }
  state_ = is_lost || !is_homed_ ? State::kAlarm : State::kIdle;
  dwells_ = lies_idle_ = false;
  is_moving_ = false;
  line_.clear();
  say(setup_.banner);
}

void GrblModel::take(char c) {
  if (c == '?') return report();
  if (c == '\x18') return soft_reset();
  if (c == '!') {
    if (state_ == State::kRun) hold_s_ = kHoldS;
    if (state_ == State::kIdle) hold_s_ = 0.0;
    if (state_ == State::kRun || state_ == State::kIdle) state_ = State::kHold;
    return;
  }
  if (c != '\n') {
    line_ += c;
    return;
  }
  obey(std::exchange(line_, {}));
}

void GrblModel::report() {
  if (state_ == State::kHome) return;  // GRBL is deaf to it while homing
  static const std::map<State, std::string> kNames{{State::kAlarm, "Alarm"}, {State::kIdle, "Idle"},
                                                   {State::kRun, "Run"},     {State::kHold, "Hold"},
                                                   {State::kDoor, "Door:1"}, {State::kHome, "Home"}};
  std::string name = kNames.at(state_);
  if (state_ == State::kHold) name += hold_s_ > 0.0 ? ":1" : ":0";
  if (lies_idle_) name = "Idle";
  const char* kind = setting(10) == 1.0 ? "MPos" : "WPos";
  say(fmt::format("<{}|{}:{:.3f},{:.3f},0.000|FS:0,0>", name, kind, at_[0], at_[1]));
}

void GrblModel::obey(const std::string& line) {
  if (line == "$$") {
    for (const auto& [number, value] : settings_) say(fmt::format("${}={:.3f}", number, value));
    return say("ok");
  }
  if (line == "$H") {
    if (setup_.homing_alarm != 0) {
      state_ = State::kAlarm;
      return say(fmt::format("ALARM:{}", setup_.homing_alarm));
    }
    state_ = State::kHome;
    home_s_ = kHomeS;
    return;
  }
  if (line == "$X") {
    if (state_ == State::kAlarm) state_ = State::kIdle;
    return say("ok");
  }
  if (line.starts_with("G90") && !is_homed_) moved_before_home_ = true;
  if (state_ == State::kAlarm || setup_.is_locked_after_home) return say("error:9");
  if (line.starts_with("G4")) {
    dwells_ = true;
    return;
  }
  line.starts_with("G90") ? begin_move(line) : say("error:20");
}

}  // namespace enamel::twin
