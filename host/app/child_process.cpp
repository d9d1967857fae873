#include "host/app/child_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

namespace enamel::app {

namespace {

void redirect(const std::string& path, int to) {
  if (path.empty()) return;
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (fd >= 0) ::dup2(fd, to);
}

// Between fork and exec: only async-signal-safe calls.
[[noreturn]] void become(char* const* argv, const ChildOptions& options, int report_fd) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  redirect(options.stdout_path, STDOUT_FILENO);
  redirect(options.stderr_path, STDERR_FILENO);
  ::execv(argv[0], argv);
  const int reason = errno;
  [[maybe_unused]] const ssize_t told = ::write(report_fd, &reason, sizeof(reason));
  ::_exit(127);
}

}  // namespace

Result<ChildProcess> ChildProcess::start(const std::vector<std::string>& argv, const ChildOptions& options) {
  std::vector<char*> raw;
  raw.reserve(argv.size() + 1);
  for (const std::string& argument : argv) raw.push_back(const_cast<char*>(argument.c_str()));
  raw.push_back(nullptr);
  std::array<int, 2> report{};
  if (::pipe2(report.data(), O_CLOEXEC) != 0) return fail(ErrorCode::kInternal, std::strerror(errno));
  const pid_t pid = ::fork();
  if (pid == 0) become(raw.data(), options, report[1]);
  ::close(report[1]);
  int reason = 0;
  const ssize_t told = pid > 0 ? ::read(report[0], &reason, sizeof(reason)) : -1;
  ::close(report[0]);
  if (pid < 0) return fail(ErrorCode::kInternal, std::string("fork: ") + std::strerror(errno));
  if (told > 0) {
    ::waitpid(pid, nullptr, 0);
    return fail(ErrorCode::kFileNotFound, argv[0] + ": " + std::strerror(reason));
  }
  return ChildProcess(pid);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept : pid_(std::exchange(other.pid_, -1)), code_(other.code_) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  if (this != &other) {
    end();
    pid_ = std::exchange(other.pid_, -1);
    code_ = other.code_;
  }
  return *this;
}

ChildProcess::~ChildProcess() { end(); }

std::optional<int> ChildProcess::poll() {
  if (code_ || pid_ < 0) return code_;
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) == pid_) {
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  return code_;
}

std::optional<int> ChildProcess::wait(Clock& clock, Nanoseconds timeout) {
  const HostTime deadline = clock.now() + timeout;
  while (!poll() && clock.now() < deadline) clock.sleep_for(std::chrono::milliseconds(5));
  return code_;
}

void ChildProcess::signal(int number) const {
  if (pid_ > 0 && !code_) ::kill(pid_, number);
}

void ChildProcess::end() noexcept {
  if (pid_ < 0 || poll()) return;
  signal(SIGTERM);
  SteadyClock clock;
  if (!wait(clock, std::chrono::seconds(1))) {
    signal(SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
}

std::string sibling_program(const std::string& name) {
  std::error_code ec;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ec);
  return (self.parent_path() / name).string();
}

}  // namespace enamel::app
