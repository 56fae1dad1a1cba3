#include "victorious/base/write_access.h"

#include <fcntl.h>
#include <unistd.h>

namespace victorious {

bool IsWritable(const std::filesystem::path& path) {
  return ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) == 0;  // by the effective user, as open(2) does
}

}  // namespace victorious
