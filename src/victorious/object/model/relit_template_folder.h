// Relit templates on disk: a later search of the same models under a similar sun finds them. To make them is a quarter
// of the time of a short video, and most of the time before its first frame is searched.
//
//   FOLDER/HASH/SUN_VIEW-VIEW[h]  one template (h: at half resolution); HASH is that of the build and of the model
//   FOLDER/HASH/shape-...         what templates of the search by shape are made of
//   (search/recognize/shape_templates.h)
//   FOLDER/tidied                 written when the folder was last looked through for what to remove
//
// Only the build that made a template reads it, with the same version of OpenCV, so that a search finds the same with
// and without the folder. Whatever cannot be read or written, or is damaged, is no error: the template is made again.
// Several processes may share the folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/object/features/relit_templates.h"

namespace victorious {

/// A template as bytes, with their checksum.
[[nodiscard]] std::vector<std::byte> PackRelitTemplate(const RelitTemplate& one);

/// Safe for any bytes. std::nullopt for what PackRelitTemplate did not write.
[[nodiscard]] std::optional<RelitTemplate> UnpackRelitTemplate(std::span<const std::byte> bytes);

/// The templates of one model. Thread-safe.
class StoredRelitTemplates {
 public:
  explicit StoredRelitTemplates(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// std::nullopt if it is not there.
  [[nodiscard]] std::optional<RelitTemplate> Find(const RelitTemplateKey& key) const;
  void Put(const RelitTemplateKey& key, const RelitTemplate& made) const;

  /// Other bytes that are made of the model, under the name of a file. std::nullopt if they are not there, or damaged.
  [[nodiscard]] std::optional<std::vector<std::byte>> FindBytes(const std::string& name) const;
  void PutBytes(const std::string& name, std::span<const std::byte> bytes) const;

 private:
  [[nodiscard]] std::filesystem::path PathOf(const RelitTemplateKey& key) const;

  std::filesystem::path folder_;
};

/// Thread-safe.
class RelitTemplateFolder {
 public:
  static constexpr std::int64_t kDefaultMaxBytes = 2'000'000'000;

  /// Removes, at most once an hour, the templates of the models that were not searched for the longest time, until all
  /// others take no more than `max_bytes`.
  /// @param folder  created if it does not exist
  /// @param build   identifies what makes the templates (ProgramId)
  RelitTemplateFolder(std::filesystem::path folder, std::string build, std::int64_t max_bytes = kDefaultMaxBytes);

  /// For this build. Null if the executable cannot be read.
  [[nodiscard]] static std::shared_ptr<const RelitTemplateFolder> Open(std::filesystem::path folder);

  /// The templates of the model of this content (ObjectModel::id), which is now in use.
  [[nodiscard]] std::unique_ptr<const StoredRelitTemplates> Of(std::string_view model_id) const;

 private:
  std::filesystem::path folder_;
  std::string build_;
};

/// The folder of this user, for this build: victorious/templates in $XDG_CACHE_HOME, or in ~/.cache. Null if there is
/// no such place.
[[nodiscard]] std::shared_ptr<const RelitTemplateFolder> OpenUsersRelitTemplates();

}  // namespace victorious
