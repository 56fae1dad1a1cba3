// What `victorious serve` gives the API.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "victorious/apps/serve/base_map.h"
#include "victorious/apps/serve/copy_folder.h"
#include "victorious/apps/serve/request_guard.h"

namespace victorious {

/// What the page offers to try on an empty index.
struct SampleFiles {
  std::filesystem::path scene;   ///< that `victorious simulate` makes a flight of
  std::filesystem::path object;  ///< CAD file of an object of the scene
};

struct ApiOptions {
  std::string index;                      ///< by the name that OpenStore takes; without a password
  std::filesystem::path models;           ///< model library, for the images of views; empty: none
  std::optional<std::string> telemetry;   ///< of the only video that the index has; std::nullopt: found by itself
  std::filesystem::path web;              ///< the built page
  std::filesystem::path uploads;          ///< where uploaded files go; created when it is needed
  std::filesystem::path copies;           ///< where the videos go that are made for users; created when it is needed
  std::filesystem::path categories = {};  ///< category model that videos are searched for, and that reviews refine
  BaseMap base_map = {};
  /// Folders whose files may be opened where the index names them, besides those of the index, of uploads and copies,
  /// and the current one.
  std::vector<std::filesystem::path> videos = {};
  std::vector<std::filesystem::path> secrets = {};  ///< files that are never opened for the index: a private key
  std::filesystem::path access_log = {};            ///< of who reads what (access_log.h); empty: none
  std::optional<SampleFiles> sample = {};           ///< std::nullopt: none
  std::uint64_t max_copies_bytes = CopyFolder::Limits().max_bytes;
  /// Uploads that no job and no video has, and jobs that are open; one account may have a fifth of each.
  std::size_t max_uploads = 2000;
  std::size_t max_jobs = 500;
  std::chrono::hours upload_expiry{24};        ///< after which an upload that no job and no video has is removed
  std::vector<std::string> live_sources = {};  ///< hosts of live sources; empty: any but CheckSource's
  std::uint64_t max_upload_bytes = std::uint64_t{50} << 30;
  ServerIdentity server;
};

}  // namespace victorious
