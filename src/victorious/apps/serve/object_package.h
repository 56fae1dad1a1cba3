// The objects that match a query as a GeoPackage (show/export/export_gpkg.h) on the disk: what *Save* of the page asks
// for.
#pragma once

#include "victorious/apps/serve/http_message.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/store/triage_store.h"

namespace victorious {

enum class VideoNames { kWhole, kWithoutFolders };

/// Writes the file into a folder of its own below that for temporary files, which only the server's user may read and
/// which goes once it is sent. All of it is the index at one moment. Errors: kCancelled; those of the store and of
/// writing.
[[nodiscard]] Expected<FileSlice> MakeObjectPackage(TriageStore& store, const ObjectQuery& query, VideoNames names,
                                                    const CancelToken& cancel);

}  // namespace victorious
