#include "victorious/jobs/association_options.h"

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "victorious/base/options.h"

namespace victorious {
namespace {

// As the index keeps them.
struct StoredAssociation {
  ObjectOptions objects;
  GroundOptions ground;

  void ListFields(FieldList& fields) {
    fields.AddGroup("objects", objects);
    fields.AddGroup("ground", ground);
  }
};

// Of a ground that was made: its options, and the size and time of its files.
std::string IdentifyGround(const GroundOptions& ground) {
  std::string id = OptionsToJsonText(ground);
  for (const std::string& file : {ground.terrain, ground.geoid_grid}) {
    std::error_code error;
    const auto size = std::filesystem::file_size(file, error);
    const auto time = std::filesystem::last_write_time(file, error);
    if (!file.empty() && !error) id += fmt::format(" {} {}", size, time.time_since_epoch().count());
  }
  return id;
}

// It is opened from whatever folder the program is started in.
void MakeWhole(std::string& path) {
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(path, error);
  if (!path.empty() && !error) path = whole.string();
}

}  // namespace

Expected<ObjectOptions> PrepareAssociation(ObjectOptions objects, const GroundOptions& ground,
                                           const WarningSink& warn) {
  StoredAssociation stored{.objects = objects, .ground = ground};
  MakeWhole(stored.ground.terrain);
  MakeWhole(stored.ground.geoid_grid);
  objects.kept_json = OptionsToJsonText(stored);
  VICTORIOUS_ASSIGN_OR_RETURN(objects.ground, MakeGround(ground, warn));
  if (objects.ground) objects.ground_id = IdentifyGround(stored.ground);
  return objects;
}

Expected<ObjectOptions> ReadAssociation(IndexStore& store, const WarningSink& warn) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string json, store.AssociationOptions());
  StoredAssociation stored;
  if (json.empty()) {
    if (warn)
      warn(
          "the index does not say by which parameters its objects were made, as an older version made them: they are "
          "made "
          "anew by the defaults, without a ground");
  } else {
    FieldList fields;
    stored.ListFields(fields);
    if (const Status read = SetFromJsonText(json, fields.fields()); !read) {
      return Fail(ErrorCode::kDataLoss, "the stored options of data association: " + read.error().message);
    }
  }
  return PrepareAssociation(std::move(stored.objects), stored.ground, warn);
}

}  // namespace victorious
