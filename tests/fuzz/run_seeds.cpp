// run_seeds N [FIRST] [CORPUS]: a fuzz target without libFuzzer, on the files of CORPUS, then on N inputs drawn from
// seeds FIRST, FIRST + 1, …: random bytes, or a file of the corpus with some bytes altered. A crash names its input.
// Every compiler and sanitizer can run it.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Input = std::vector<std::uint8_t>;

std::vector<Input> read_corpus(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Input> corpus;
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    Input& bytes = corpus.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    std::fprintf(stderr, "%s\n", file.c_str());
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  return corpus;
}

Input draw(std::uint64_t seed, const std::vector<Input>& corpus) {
  std::mt19937_64 random(seed);
  if (!corpus.empty() && seed % 2 == 0) {
    Input bytes = corpus[random() % corpus.size()];
    for (std::uint64_t edits = 1 + random() % 8; edits > 0 && !bytes.empty(); --edits) {
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    }
    return bytes;
  }
  Input bytes(64 + random() % 4096);
  for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
  const std::vector<Input> corpus = read_corpus(argc > 3 ? argv[3] : "");
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    std::fprintf(stderr, "\rseed %llu ", static_cast<unsigned long long>(seed));
    const Input bytes = draw(seed, corpus);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
  std::fprintf(stderr, "\n%zu files and %llu random inputs, none crashed\n", corpus.size(),
               static_cast<unsigned long long>(count));
  return 0;
}
