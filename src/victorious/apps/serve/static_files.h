// The files of the page: a folder that `make build` fills from web/. Nothing outside of it is sent.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/apps/serve/http_message.h"

namespace victorious {

class StaticFiles {
 public:
  /// @param folder  the built page; empty or without index.html: "/" says how to build it
  explicit StaticFiles(std::filesystem::path folder);

  /// The file at a path below the folder; without segments its index.html. 404 for anything else, also for a symbolic
  /// link that leads out of the folder.
  [[nodiscard]] HttpResponse Get(const HttpRequest& request, const std::vector<std::string>& segments) const;

 private:
  std::filesystem::path folder_;  ///< canonical; empty: there is none
};

/// The content type of a file name; "application/octet-stream" if it is not known.
[[nodiscard]] std::string ContentTypeOf(const std::filesystem::path& name);

/// An entity tag of size and time of change, with quotes; empty if the file is not there.
[[nodiscard]] std::string FileEtag(const std::filesystem::path& file);

}  // namespace victorious
