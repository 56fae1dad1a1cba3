// A format of `export`: a row of the table in export.cc, and the file that writes it.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "victorious/base/error.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/index_store.h"

namespace victorious {

struct ExportOptions {
  std::string cot_type;  ///< of all events of Cursor-on-Target, as "a-h-G-E-V"; empty: CotTypeOf
  /// When they are generated, microseconds since 1970; std::nullopt: now.
  std::optional<std::int64_t> now_utc_us;
};

struct ExportRequest {
  IndexStore& store;
  const Catalogue& catalogue;  ///< of what matches the filter
  const SightingFilter& filter;
  const ExportOptions& options;
};

struct ExportFormat {
  std::string_view name;                                         ///< of `export --format`
  std::string_view file;                                         ///< what such a file is, as "a KML file"
  bool is_map = false;                                           ///< holds only objects of known place
  bool is_binary = false;                                        ///< else text
  bool (*is_file)(std::string_view head);                        ///< whether a file that begins so is of this format
  Status (*write)(const ExportRequest& request, std::ostream&);  ///< row by row; errors: those of the store and its own
};

}  // namespace victorious
