// Runs a fuzz target without a fuzzer, on its seeds and on mutations of them from a fixed random seed; takes seconds.
// On failure, writes the input to a file.
//   TARGET_replay [MUTATIONS]     the test; 200 mutations by default
//   TARGET_replay --write FOLDER  writes the seeds, the initial corpus of libFuzzer
//   TARGET_replay --run FILE...   runs these inputs, for instance failures of libFuzzer or of a test
#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/random.h"

namespace {

namespace fs = std::filesystem;
using victorious::Random;

constexpr std::uint64_t kSeed = 20240607;
constexpr int kDefaultMutations = 200;

std::string current_input;
std::string failure_path;

void Save(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// Functions that are async-signal-safe only: the heap may be what is broken, and its lock held.
void SaveInputAndEnd(int /*signal*/) {
  const auto write_all = [](int file, std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = write(file, bytes.data(), bytes.size());
      if (written <= 0) return;
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  };
  constexpr int kPermissions = 0644;
  const int file = open(failure_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, kPermissions);
  if (file >= 0) write_all(file, current_input);
  write_all(STDERR_FILENO, "ended by a signal; the input is in ");
  write_all(STDERR_FILENO, failure_path);
  write_all(STDERR_FILENO, "\n");
  _exit(1);
}

void Run(const std::string& input) {
  current_input = input;
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

// One mutation: flips a bit, sets a byte, truncates, inserts, or copies from another place.
void Mutate(std::string& bytes, Random& random) {
  if (bytes.empty()) {
    bytes.push_back(static_cast<char>(random.Next()));
    return;
  }
  const auto size = static_cast<std::uint32_t>(bytes.size());
  const std::uint32_t at = random.Below(size);
  constexpr std::uint32_t kMaxRun = 64;
  const std::uint32_t run = std::min(random.Below(kMaxRun) + 1, size - at);
  switch (random.Below(6)) {
    case 0:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.Below(8)));
      return;
    case 1:
      bytes[at] = static_cast<char>(random.Next());
      return;
    case 2:
      std::fill_n(bytes.begin() + at, run, random.Below(2) == 0 ? '\0' : '\xFF');
      return;
    case 3:
      bytes.resize(at);
      return;
    case 4:
      bytes.insert(at, bytes.substr(random.Below(size), run));
      return;
    default:
      bytes.erase(at, run);
      return;
  }
}

void RunMutations(int count) {
  const std::vector<std::string> seeds = FuzzSeeds();
  for (const std::string& seed : seeds) Run(seed);
  Run("");
  Random random(kSeed);
  for (int i = 0; i < count; ++i) {
    std::string input = seeds[static_cast<std::size_t>(i) % seeds.size()];
    for (std::uint32_t changes = random.Below(4) + 1; changes > 0; --changes) Mutate(input, random);
    Run(input);
  }
  std::printf("%zu seeds and %d mutations of them (seed %llu)\n", seeds.size(), count,
              static_cast<unsigned long long>(kSeed));
}

int WriteSeeds(const fs::path& folder) {
  fs::create_directories(folder);
  const std::vector<std::string> seeds = FuzzSeeds();
  for (std::size_t i = 0; i < seeds.size(); ++i) Save(folder / ("seed" + std::to_string(i)), seeds[i]);
  return 0;
}

int RunFiles(std::span<char* const> paths) {
  for (const char* path : paths) {
    std::ifstream file(path, std::ios::binary);
    Run({std::istreambuf_iterator<char>(file), {}});
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char* const> arguments(argv, static_cast<std::size_t>(argc));
  failure_path = fs::path(argv[0]).filename().string() + ".failure";
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGILL, SIGBUS}) std::signal(signal, &SaveInputAndEnd);
  const std::string_view first = argc > 1 ? arguments[1] : "";
  if (first == "--write" && argc == 3) return WriteSeeds(arguments[2]);
  if (first == "--run") return RunFiles(arguments.subspan(2));
  int mutations = kDefaultMutations;
  const auto parsed = std::from_chars(first.data(), first.data() + first.size(), mutations);
  if (argc > 2 || (argc == 2 && (parsed.ec != std::errc() || parsed.ptr != first.data() + first.size()))) {
    std::fprintf(stderr, "usage: %s [MUTATIONS | --write FOLDER | --run FILE...]\n", argv[0]);
    return 2;
  }
  RunMutations(mutations);
  return 0;
}
