#include "victorious/base/program_id.h"

#include <span>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/own_file.h"
#include "victorious/base/version.h"

namespace victorious {

Expected<std::string> ProgramId() {
  // Of the program itself, the file that runs, though another may stand in its place by now.
  static const Expected<std::string> id = ComputeProgramId(IsOwnProgram() ? "/proc/self/exe" : OwnFile());
  return id;
}

Expected<std::string> ComputeProgramId(const std::filesystem::path& executable) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(executable));
  return fmt::format("{}-{:016x}", kVersion, Checksum(std::as_bytes(std::span(bytes))));
}

}  // namespace victorious
