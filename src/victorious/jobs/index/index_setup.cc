#include "victorious/jobs/index/index_setup.h"

#include <algorithm>

#include <fmt/format.h>

#include "victorious/category/finder/detection_list_source.h"

namespace victorious {

const ModelRecord* FindSame(const std::vector<ModelRecord>& records, const ModelRecord& sought) {
  const auto found = std::ranges::find_if(records, [&](const ModelRecord& record) {
    return record.name == sought.name && record.content_id == sought.content_id;
  });
  return found == records.end() ? nullptr : &*found;
}

// The index identifies models and categories by name, so one would overwrite the other.
Status CheckNames(const std::vector<ModelRecord>& sought, const std::vector<ModelRecord>& others) {
  for (const ModelRecord& one : sought) {
    for (const ModelRecord& other : others) {
      if (one.name != other.name) continue;
      if (one.IsBoxed() != other.IsBoxed()) {
        return Fail(ErrorCode::kInvalidArgument,
                    fmt::format("{}: is the name of what people boxed: rename the category", one.name));
      }
      const bool is_listed = one.content_id.starts_with(kListedContentId);
      if (is_listed != other.content_id.starts_with(kListedContentId)) {
        return Fail(
            ErrorCode::kInvalidArgument,
            fmt::format("{}: is the name of a category that is searched for, and of what another program found: "
                        "rename one of them (--detector)",
                        one.name));
      }
      if (one.IsCategory() == other.IsCategory()) continue;
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: is the name of both a model and a category: rename one of them", one.name));
    }
  }
  return {};
}

}  // namespace victorious
