// What several commands need of their arguments and output.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>

#include "victorious/base/cancel.h"
#include "victorious/base/error.h"
#include "victorious/base/options.h"
#include "victorious/geometry/box.h"
#include "victorious/store/index_store.h"
#include "victorious/terrain/terrain.h"

namespace victorious::cli {

/// What --ground and its like were given.
struct GroundArguments {
  std::optional<double> height_m;
  std::string terrain;
  std::string vertical_datum;
  std::string geoid_grid;
};

/// "x,y,w,h" in pixels.
Expected<Box> ParseBox(std::string_view text);

/// A time of a video, as seconds ("90", "12.5") or with minutes or hours before them ("1:30", "1:02:03.5"), in seconds
/// from 0 on. Error: kInvalidArgument.
Expected<double> ParseTime(std::string_view text);

/// For options that hold seconds: takes what ParseTime takes.
CLI::Validator TimeOfVideo();

/// "latitude,longitude,metres", degrees.
Expected<Surroundings> ParseSurroundings(std::string_view text);

/// The option --params. `lists` is what `victorious params` lists them by.
void AddParams(CLI::App& app, std::string& params, std::string_view lists);

/// The option --hfov.
void AddFieldOfView(CLI::App& app, std::optional<double>& hfov_deg);

/// The options --ground, --terrain, --terrain-datum and --geoid; `ground` keeps what they do not set.
void AddGround(CLI::App& app, GroundArguments& ground);

/// Sets those that were given.
void ApplyGround(const GroundArguments& arguments, GroundOptions& options);

/// Reads `--params FILE` (JSON) into the fields, or a preset by its name (pipeline/preset.h; a file of that name is
/// ./NAME); an empty path changes nothing.
Status ReadParams(const std::string& path, const std::vector<FieldRef>& fields);

/// A parameter that a flag sets.
struct FlagOfField {
  std::string_view field;  ///< its full name
  std::string_view flag;
};

/// Checks parameters that flags set, so that what is wrong is told of the flag. Error: kInvalidArgument.
Status CheckFlags(const std::vector<FieldRef>& fields, std::initializer_list<FlagOfField> flags);

/// Writes to stdout (`path` empty or "-"), or to a file, whole or not at all.
Status WriteOutput(const std::string& path, std::string_view text);

/// Whether WriteOutput could write there, asked before long work.
Status CheckOutput(const std::string& path);

/// The text with its control characters (of a file's name, say) replaced by '?': a message stays one line.
std::string OneLine(std::string text);

/// Set by SIGINT and SIGTERM.
CancelToken& Interrupt();

/// The flags --video, --model, --category, --from, --to, --near and --rejected of commands that list what an index
/// holds.
struct FilterArguments {
  std::string video;
  std::string model;
  std::string category;
  std::optional<double> from_s;
  std::optional<double> to_s;
  std::string near;
  bool rejected = false;

  void AddTo(CLI::App& app);
  /// Errors: kInvalidArgument for times that end before they begin; for no place; for both a
  /// model and a category.
  [[nodiscard]] Expected<SightingFilter> Filter() const;
};

/// Why no object is near the place that a filter asks for, for a person; empty where one is, or none is asked for.
Expected<std::string> WhyNoneIsNear(SightingFilter filter, IndexStore& store);

}  // namespace victorious::cli
