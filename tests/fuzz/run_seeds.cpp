// run_seeds N [FIRST]: a fuzz target without libFuzzer, on N inputs drawn from seeds FIRST, FIRST + 1, …; a crash names
// its seed. Every compiler and sanitizer can run it.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    std::fprintf(stderr, "\rseed %llu ", static_cast<unsigned long long>(seed));
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> bytes(64 + random() % 4096);
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::fprintf(stderr, "\n%llu inputs, none crashed\n", static_cast<unsigned long long>(count));
  return 0;
}
