// Responses that are whole files.
#pragma once

#include <filesystem>
#include <string>

#include "victorious/apps/serve/api_error.h"
#include "victorious/apps/serve/copy_folder.h"
#include "victorious/apps/serve/http_message.h"

namespace victorious {

/// @param name  that tells what kind of file it is
/// Error: kNotFound for a file that cannot be read.
[[nodiscard]] ApiExpected<HttpResponse> SendFile(const HttpRequest& request, const std::filesystem::path& path,
                                                 const std::filesystem::path& name);

/// A file that was made for users, by its name; it stays until it is sent. Error: kNotFound.
[[nodiscard]] ApiExpected<HttpResponse> SendMade(const HttpRequest& request, CopyFolder& copies,
                                                 const std::string& name);

}  // namespace victorious
