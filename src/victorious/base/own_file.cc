#include "victorious/base/own_file.h"

#include <system_error>

#include <dlfcn.h>
#include <link.h>

namespace victorious {

std::filesystem::path OwnFile() {
  static const std::filesystem::path file = [] {
    std::error_code error;
    Dl_info info{};
    link_map* module = nullptr;
    const auto address = reinterpret_cast<void*>(&OwnFile);
    const bool is_found = ::dladdr1(address, &info, reinterpret_cast<void**>(&module), RTLD_DL_LINKMAP) != 0;
    // The program itself has no name in the list of what is loaded.
    if (is_found && module != nullptr && module->l_name != nullptr && *module->l_name != '\0') {
      return std::filesystem::canonical(module->l_name, error);
    }
    return std::filesystem::read_symlink("/proc/self/exe", error);
  }();
  return file;
}

}  // namespace victorious
