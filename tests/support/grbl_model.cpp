#include "tests/support/grbl_model.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace enamel::test {
namespace {

constexpr double kHoldS = 0.03;
constexpr double kHomeS = 0.05;
constexpr double kBootS = 0.05;
constexpr double kWanderS = 0.004;  // after it stood

const std::map<int, double> kUsual{{1, 255},   {10, 1},    {13, 0},    {20, 1},    {22, 1},
                                   {23, 3},    {27, 1},    {32, 0},    {100, 800}, {101, 800},
                                   {102, 250}, {110, 1e5}, {111, 1e5}, {130, 400}, {131, 70}};

void make_raw(const std::string& port) {
  const int slave = ::open(port.c_str(), O_RDWR | O_NOCTTY);
  termios t{};
  ::tcgetattr(slave, &t);
  ::cfmakeraw(&t);
  ::tcsetattr(slave, TCSANOW, &t);
  ::close(slave);  // from here on the master sees a hang-up until somebody opens the port
}

}  // namespace

GrblModel::GrblModel(GrblModelSetup setup) : setup_(std::move(setup)), settings_(kUsual), random_(setup_.seed) {
  for (const auto& [number, value] : setup_.settings) settings_[number] = value;
  master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0)
    throw std::runtime_error("no pseudo-terminal");
  port_ = ::ptsname(master_);
  make_raw(port_);
  thread_ = std::thread([this] { run(); });
}

GrblModel::~GrblModel() {
  ends_ = true;
  thread_.join();
  if (master_ >= 0) ::close(master_);
}

void GrblModel::arm(GrblFault fault, double share) {
  const std::lock_guard lock(mutex_);
  armed_ = fault;
  armed_share_ = share;
}

std::array<double, 2> GrblModel::position() const {
  const std::lock_guard lock(mutex_);
  return at_;
}

std::pair<std::array<double, 2>, std::array<double, 2>> GrblModel::range() const {
  const std::lock_guard lock(mutex_);
  return {low_, high_};
}

void GrblModel::run() {
  bool was_open = false;
  double boot_s = -1.0;
  Time last = std::chrono::steady_clock::now();
  while (!ends_) {
    pollfd p{master_, POLLIN, 0};
    ::poll(&p, master_ >= 0 ? 1U : 0U, 1);
    const std::lock_guard lock(mutex_);
    const bool is_open = (p.revents & POLLHUP) == 0;
    if (is_open && !was_open && setup_.boots_on_open) boot_s = kBootS;
    if (!is_open) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    was_open = is_open;
    const Time now = std::chrono::steady_clock::now();
    const double dt = std::chrono::duration<double>(now - last).count();
    last = now;
    if (boot_s > 0.0 && (boot_s -= dt) <= 0.0) boot();
    char buffer[256];
    const ssize_t n = (p.revents & POLLIN) != 0 ? ::read(master_, buffer, sizeof(buffer)) : 0;
    for (ssize_t i = 0; i < n && !is_silent_; ++i) take(buffer[i]);
    step(dt);
  }
}

void GrblModel::say(std::string line) {
  if (is_silent_ || master_ < 0 || setup_.banner.empty()) return;
  if (line == "ok" && lost_oks_ > 0) {
    --lost_oks_;
    return;
  }
  if (bad_lines_ > 0) {
    --bad_lines_;
    const std::size_t at = std::uniform_int_distribution<std::size_t>(0, line.size() - 1)(random_);
    line[at] = static_cast<char>(line[at] ^ 0x15);
  }
  line += "\r\n";
  // What a closed port does not take is lost, as on a wire.
  static_cast<void>(!::write(master_, line.data(), line.size()));
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

void GrblModel::begin_move(const std::string& line) {
  double x = 0.0, y = 0.0, feed = 0.0;
  if (std::sscanf(line.c_str(), "G90 G21 G94 G53 G1 X%lf Y%lf F%lf", &x, &y, &feed) != 3) return say("error:2");
  // Noise on the way to the controller, which has no checksum to notice it by.
  if (armed_ == GrblFault::kOtherTarget) x = x < -200.0 ? x + 30.0 : x - 30.0;
  if (armed_ == GrblFault::kFarTarget) x = -5.0;
  if (armed_ == GrblFault::kOtherTarget || armed_ == GrblFault::kFarTarget) armed_ = GrblFault::kNone;
  const auto is_out = [](double v, double travel) { return v < -travel - 1e-6 || v > 1e-6; };
  if (setting(20) == 1.0 && (is_out(x, setting(130)) || is_out(y, setting(131)))) {
    state_ = State::kAlarm;
    return say("ALARM:2");
  }
  const std::array<double, 2> to{x, y};
  leg_ = {at_, to, std::hypot(x - at_[0], y - at_[1]) / feed * 60.0, 0.0};
  if (leg_.seconds > 0.0) {
    from_below_ = to[0] >= at_[0] && to[1] >= at_[1];
    state_ = State::kRun;
    is_moving_ = true;
    ++moves_;
  }
  say("ok");
}

void GrblModel::end_leg(double share) {
  for (std::size_t i = 0; i < 2; ++i) {
    at_[i] = leg_.from[i] + share * (leg_.to[i] - leg_.from[i]);
    low_[i] = std::min(low_[i], at_[i]);
    high_[i] = std::max(high_[i], at_[i]);
  }
}

void GrblModel::step(double dt) {
  if (state_ == State::kHome && (home_s_ -= dt) <= 0.0) {
    at_ = {-setting(130) + setting(27), -setting(131) + setting(27)};
    low_ = high_ = at_;
    is_homed_ = true;
    state_ = State::kIdle;
    say("ok");
  }
  const bool holds = state_ == State::kHold && hold_s_ > 0.0;
  if (state_ == State::kRun || holds) {
    leg_.done_s += dt;
    const double share = leg_.seconds > 0.0 ? std::min(1.0, leg_.done_s / leg_.seconds) : 1.0;
    end_leg(share);
    if (armed_ != GrblFault::kNone && share >= armed_share_) strike(std::exchange(armed_, GrblFault::kNone));
    if (holds && (hold_s_ -= dt) <= 0.0) is_moving_ = false;
    if (state_ == State::kRun && share >= 1.0) {
      state_ = State::kIdle;
      is_moving_ = lies_idle_ = false;
    }
  }
  if (dwells_ && state_ == State::kIdle) {
    dwells_ = false;
    say("ok");
  }
  if (wander_s_ > 0.0 && state_ == State::kIdle && (wander_s_ -= dt) <= 0.0) at_[0] += 0.05;
}

void GrblModel::strike(GrblFault fault) {
  const auto halt = [&](State state) {
    state_ = state;
    is_moving_ = false;
  };
  switch (fault) {
    case GrblFault::kHardLimit:
      halt(State::kAlarm);
      is_homed_ = dwells_ = false;
      return say("ALARM:1");
    case GrblFault::kRestart:
      return boot();
    case GrblFault::kPowerOff:
      halt(State::kAlarm);
      is_silent_ = true;
      return;
    case GrblFault::kUnplug:
      ::close(std::exchange(master_, -1));
      return;
    case GrblFault::kHang:
      is_silent_ = true;
      return;
    case GrblFault::kNoise:
      bad_lines_ = 1 << 30;
      return;
    case GrblFault::kOneBadByte:
      bad_lines_ = 1;
      return;
    case GrblFault::kLostOk:
      lost_oks_ = 1;
      return;
    case GrblFault::kShort:
      return halt(State::kIdle);
    case GrblFault::kWander:
      wander_s_ = kWanderS;
      return;
    case GrblFault::kIdleInMove:
      lies_idle_ = true;
      return;
    case GrblFault::kOkInMove:
      dwells_ = false;
      return say("ok");
    case GrblFault::kDoor:
      return halt(State::kDoor);
    default:
      return;
  }
}

}  // namespace enamel::test
