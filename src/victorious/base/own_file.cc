#include "victorious/base/own_file.h"

#include <system_error>

#include <dlfcn.h>
#include <link.h>

namespace victorious {
namespace {

// The path by which the shared library was loaded; empty: this is the program itself, which has no name in the list of
// what is loaded.
std::filesystem::path LoadedName() {
  Dl_info info{};
  link_map* module = nullptr;
  const auto address = reinterpret_cast<void*>(&OwnFile);
  const bool is_found = ::dladdr1(address, &info, reinterpret_cast<void**>(&module), RTLD_DL_LINKMAP) != 0;
  return is_found && module != nullptr && module->l_name != nullptr ? module->l_name : "";
}

// When the code is loaded: the path may be relative to the folder that is current then.
[[maybe_unused]] const bool is_found_when_loaded = !OwnFile().empty();

}  // namespace

bool IsOwnProgram() {
  static const bool is_program = LoadedName().empty();
  return is_program;
}

std::filesystem::path OwnFile() {
  static const std::filesystem::path file = [] {
    std::error_code error;
    return IsOwnProgram() ? std::filesystem::read_symlink("/proc/self/exe", error)
                          : std::filesystem::canonical(LoadedName(), error);
  }();
  return file;
}

}  // namespace victorious
