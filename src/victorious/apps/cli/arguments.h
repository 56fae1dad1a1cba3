// Argument parsing, parameter files and output shared by several commands.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/apps/cli/argument_parser.h"
#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/file_roots.h"
#include "victorious/base/file_writer.h"
#include "victorious/base/one_line.h"
#include "victorious/base/options.h"
#include "victorious/geometry/box.h"
#include "victorious/input/telemetry/telemetry.h"
#include "victorious/input/terrain/terrain.h"
#include "victorious/jobs/index/index_options.h"
#include "victorious/jobs/preset.h"
#include "victorious/store/index_store.h"
#include "victorious/types/object_model.h"

namespace victorious::cli {

/// The values of --ground, --terrain, --terrain-datum and --geoid; an empty member was not given.
struct GroundArguments {
  std::optional<double> height_m;
  std::string terrain;
  std::string vertical_datum;
  std::string geoid_grid;
};

/// The values of --pitch, --yaw, --nadir, --takeoff and --camera; an empty member was not given.
struct CameraArguments {
  std::optional<double> pitch_deg;
  std::optional<double> yaw_deg;
  std::optional<double> takeoff_m;
  std::string gps_order;
  std::string vertical_datum;
  bool nadir = false;
  std::string camera;
};

/// Parses "x,y,w,h" in pixels. Error: kInvalidArgument for any other text or a box without area.
[[nodiscard]] Expected<Box> ParseBox(std::string_view text);

/// Parses a presentation time: seconds ("90", "12.5"), minutes:seconds ("1:30") or hours:minutes:seconds ("1:02:03.5").
/// Returns seconds, at least 0. Error: kInvalidArgument.
[[nodiscard]] Expected<double> ParseTime(std::string_view text);

/// Argument::Transform of options in seconds: replaces a text that ParseTime accepts by the number of seconds. Error:
/// that of ParseTime.
[[nodiscard]] Status NormalizeVideoTime(std::string& text);

/// Parses "latitude,longitude,metres" (latitude and longitude in degrees). Error: kInvalidArgument.
[[nodiscard]] Expected<GeoCircle> ParseGeoCircle(std::string_view text);

/// Adds the option --db: a SQLite file or the URL of a PostgreSQL database (store/open_store.h).
void AddDb(ArgumentParser& parser, std::string& db, std::string_view description = "The index");

/// Adds the option --files-below: folders that limit which of the files that an index names are opened.
void AddFilesBelow(ArgumentParser& parser, std::vector<std::string>& folders);

/// What its folders mean: every file if none was given.
[[nodiscard]] FileRoots RootsOf(const std::vector<std::string>& folders);

/// Checks that the argument of --db is a database, which workers share. Error: kInvalidArgument.
[[nodiscard]] Status CheckSharedDatabase(const std::string& db);

/// Adds the option --params. `lists` is the argument with which `victorious params` lists these parameters.
void AddParams(ArgumentParser& parser, std::string& params, std::string_view lists);

/// Adds the option --hfov.
void AddFieldOfView(ArgumentParser& parser, std::optional<double>& hfov_deg);

/// Adds the options --pitch, --yaw, --nadir, --takeoff and --camera: what telemetry without gimbal angles, absolute
/// heights or a field of view lacks.
void AddCamera(ArgumentParser& parser, CameraArguments& camera);

/// Copies the values that were given to `options`. Error: kInvalidArgument for a yaw without an elevation.
[[nodiscard]] Status ApplyCamera(const CameraArguments& arguments, TelemetryOptions& options);

/// Adds the options --ground, --terrain, --terrain-datum and --geoid. Options that are not given leave `ground`
/// unchanged.
void AddGround(ArgumentParser& parser, GroundArguments& ground);

/// Copies the values that were given to `options`.
void ApplyGround(const GroundArguments& arguments, GroundOptions& options);

/// Sets the fields from a JSON file. An empty path changes nothing. Errors: kNotFound; kInvalidArgument with the path.
[[nodiscard]] Status ReadParamsFile(const std::string& path, const std::vector<FieldRef>& fields);

/// Sets the options from the preset named `path` (jobs/preset.h; use ./NAME for a file with a preset's name), else
/// from that file. Errors: those of ApplyPreset and ReadParamsFile.
template <typename Options>
[[nodiscard]] Status ReadParams(const std::string& path, Options& options) {
  if (const std::optional<Preset> preset = FromText(kPresetTexts, path)) return ApplyPreset(*preset, options);
  return ReadParamsFile(path, CollectFields(options));
}

/// How a video is searched: --params, --quality and --every.
struct SearchSettings {
  std::string params;
  std::string quality;
  std::optional<int> every;
};

/// Adds the options.
void AddSearchSettings(ArgumentParser& parser, SearchSettings& search);

/// The parameters that they set: a flag overrides the file, and the file the quality. Error: kInvalidArgument for a
/// value that is none, or out of range.
[[nodiscard]] Expected<IndexOptions> ReadIndexOptions(const SearchSettings& search,
                                                      std::span<const ObjectModel> models);

/// A flag and the parameter that it sets.
struct FieldFlag {
  std::string_view field;  ///< the field's full name
  std::string_view flag;
};

/// Validates the parameters that flags set, so that the message names the flag. Error: kInvalidArgument.
[[nodiscard]] Status CheckFlags(const std::vector<FieldRef>& fields, std::initializer_list<FieldFlag> flags);

/// True for the path of an output that names no file: empty or "-".
[[nodiscard]] inline bool IsStandardOutput(std::string_view path) { return path.empty() || path == "-"; }

/// Writes `text` to stdout (`path` empty or "-"), or atomically to a file.
[[nodiscard]] Status WriteOutput(const std::string& path, std::string_view text);
/// As the above, of what `write` gives to a stream, in parts (base/file_writer.h): for what is too large for memory.
[[nodiscard]] Status WriteOutput(const std::string& path, const WriteContent& write);

/// Checks that WriteOutput can write to `path`. Called before long work.
[[nodiscard]] Status CheckOutput(const std::string& path);

/// Checks the path of a drawn image: CheckOutput, and its extension. Errors: those of CheckImageName and CheckOutput.
[[nodiscard]] Status CheckDrawnImage(const std::string& path);

/// Checks the path of a drawn video: CheckOutput, and its extension. Error: kInvalidArgument unless it is empty or ends
/// in .mp4 or .mkv.
[[nodiscard]] Status CheckDrawnVideo(const std::string& path);

/// The token that SIGINT and SIGTERM cancel. The first call installs the signal handlers.
CancelToken& Interrupt();

/// The signal that cancelled it, SIGINT or SIGTERM; 0 if none did.
[[nodiscard]] int InterruptSignal();

/// The flags --video, --model, --category, --from, --to, --near, --object, --rejected, --weak and --thresholds of the
/// commands that list the content of an index.
struct FilterArguments {
  std::string video;
  std::string model;
  std::string category;
  std::optional<double> from_s;
  std::optional<double> to_s;
  std::string near;
  std::optional<std::int64_t> object;
  bool rejected = false;
  bool weak = false;
  std::string thresholds = std::string(ToText(kThresholdUseTexts, ThresholdUse::kIgnored));

  void AddTo(ArgumentParser& parser);
  /// Returns the filter that the flags describe. Errors: kInvalidArgument if --from is after --to, if --near cannot be
  /// parsed, or if both --model and --category are given.
  [[nodiscard]] Expected<SightingFilter> Filter() const;
};

/// A message for the user that says how many of the matching objects the thresholds of their models leave out, or how
/// many are weak finds; empty if none.
[[nodiscard]] Expected<std::string> ExplainScores(const SightingFilter& filter, IndexStore& store);

/// Error: kNotFound if filter.object is set and the index has no object of this id, not even a rejected one.
[[nodiscard]] Status CheckObject(const SightingFilter& filter, IndexStore& store);

/// A message for the user that says how many matching objects are rejected and not listed; empty if none.
[[nodiscard]] Expected<std::string> ExplainRejected(SightingFilter filter, IndexStore& store);

/// A message for the user that explains why no object matches the filter: nothing near, all rejected (how many, and why
/// the best one), the flags that leave out all there are, or nothing seen. Empty if an object matches, or if
/// ExplainScores says why.
[[nodiscard]] Expected<std::string> ExplainNothingFound(const SightingFilter& filter, IndexStore& store);

/// A message for the user that says how many of the matching objects have no place, which a map leaves out, and why;
/// empty if all have one.
[[nodiscard]] Expected<std::string> ExplainUnplaced(const SightingFilter& filter, IndexStore& store);

}  // namespace victorious::cli
