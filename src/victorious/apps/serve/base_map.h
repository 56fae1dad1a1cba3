// The base map below what the page's map shows: tiles of a server, or of a PMTiles file (version 3) that this server
// sends by ranges. Without one the page draws land and a grid by itself.
#pragma once

#include <filesystem>
#include <string>

#include "victorious/base/error.h"

namespace victorious {

struct BaseMap {
  std::string url;             ///< of a tile server, with {z}, {x} and {y}; empty: there is none
  std::string origin;          ///< of `url`, as in https://tile.example.org: what browsers may fetch from
  std::filesystem::path file;  ///< PMTiles; empty: there is none
  bool is_vector = false;      ///< the file has vector tiles; those of a server are images
  int max_zoom = 19;           ///< deeper tiles are made of these
  std::string attribution;     ///< whose map it is, as plain text; empty: as the file says

  [[nodiscard]] bool IsNone() const { return url.empty() && file.empty(); }
};

/// Reads the argument of `serve --tiles`: an address (http or https) with {z}, {x} and {y}, or the path of a file.
/// @param attribution  of `serve --tiles-attribution`; empty: of a tile server its host is named
/// Errors: kInvalidArgument for an address that is none; kNotFound; kUnsupported for a file that is not PMTiles 3, or
/// whose tiles are neither vectors nor PNG, JPEG or WebP.
[[nodiscard]] Expected<BaseMap> ReadBaseMap(const std::string& argument, const std::string& attribution);

}  // namespace victorious
