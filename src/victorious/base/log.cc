#include "victorious/base/log.h"

#include <spdlog/spdlog.h>

#include "victorious/base/credentials.h"

namespace victorious {

void LogInfo(const std::string& line) { spdlog::info("{}", WithoutCredentials(line)); }
void LogWarning(const std::string& line) { spdlog::warn("{}", WithoutCredentials(line)); }
void LogError(const std::string& line) { spdlog::error("{}", WithoutCredentials(line)); }

}  // namespace victorious
