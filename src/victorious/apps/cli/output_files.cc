#include "victorious/apps/cli/output_files.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <utility>

#include <CLI/App.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/base/enum_text.h"
#include "victorious/base/file_head.h"
#include "victorious/base/folder.h"
#include "victorious/base/json.h"
#include "victorious/category/category_file.h"
#include "victorious/category/channels/channel_file.h"
#include "victorious/category/network/detector_file.h"
#include "victorious/input/image/image_header.h"
#include "victorious/input/telemetry/telemetry_file.h"
#include "victorious/place/cameras/video_telemetry.h"

namespace victorious::cli {
namespace {

namespace fs = std::filesystem;

constexpr auto kKindTexts = std::to_array<EnumText<FileKind>>(
    {{FileKind::kImage, "a PNG, JPEG, BMP or PNM image without EXIF and XMP, as photos have them"},
     {FileKind::kGeoTiff, "a GeoTIFF of a coverage"},
     {FileKind::kCameraTable, "a table of camera states (CSV)"},
     {FileKind::kTelemetryReport, "a telemetry report (JSON)"},
     {FileKind::kFeatures, "a list of features"},
     {FileKind::kCategoryModel, "a category model or a detector"},
     {FileKind::kSimulation, "in a folder of a simulation (with its truth.jsonl)"},
     {FileKind::kReport, "a report of an experiment"},
     {FileKind::kVideo, "a video that may be replaced, since it may be footage"}});

bool IsFeatures(std::string_view head) {
  const std::string_view line = FirstLine(head);
  return line.ends_with(" 128") && IsTextOf(line.substr(0, line.size() - 4), "0123456789");
}

bool IsReport(std::string_view head) {
  const bool is_text = head.find('\0') == std::string_view::npos;
  const std::string_view line = FirstLine(head);
  return IsJsonWith(head, {"\"experiment\"", "\"rows\""}) || head.starts_with("<svg") || head.starts_with("<?xml") ||
         (is_text && line.contains(',') && !line.starts_with('{'));
}

std::string ReadHead(const fs::path& path, std::error_code& failed) {
  constexpr std::size_t kHeadSize = std::size_t{1} << 16;
  std::string head(kHeadSize, '\0');
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) failed = std::error_code(errno == 0 ? EIO : errno, std::generic_category());
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head;
}

// True if `simulate` wrote the files of this folder: it writes truth.jsonl before it finishes the video.
bool IsSimulationFolder(const fs::path& folder) {
  std::error_code missing;
  const std::string truth = ReadHead(folder / "truth.jsonl", missing);
  return !missing && (truth.empty() || IsJsonLine(truth, {"frame", "object", "visible"}));
}

// True for an image that may be a camera's photo: it has EXIF or XMP, which images of the commands have not, or is a
// TIFF, in which the camera's tags may be anywhere.
bool MayBePhoto(ImageFormat format, std::string_view head) {
  if (format == ImageFormat::kTiff) return true;
  if (format == ImageFormat::kPng) {
    const std::string_view chunks = head.substr(0, head.find("IDAT"));
    return chunks.contains("eXIf") || chunks.contains("XML:com.adobe.xmp");
  }
  return head.contains(std::string_view("Exif\0\0", 6)) || head.contains("http://ns.adobe.com/xap/1.0/");
}

bool IsImage(std::string_view head) {
  const std::optional<ImageFormat> format = DetectImageFormat(std::as_bytes(std::span(head)));
  return format && !MayBePhoto(*format, head);
}

bool IsOfKind(FileKind kind, const fs::path& path, std::string_view head) {
  switch (kind) {
    case FileKind::kImage:
      return IsImage(head);
    case FileKind::kGeoTiff:
      return head.starts_with(std::string_view("II*\0", 4)) && head.contains("victorious coverage");
    case FileKind::kCameraTable:
      return FirstLine(head).contains("time_s") && FirstLine(head).contains("latitude_deg");
    case FileKind::kTelemetryReport:
      return IsJsonWith(head, {"\"format\""}) && (head.contains("\"records\"") || head.contains("\"nested_sets\""));
    case FileKind::kFeatures:
      return IsFeatures(head);
    case FileKind::kCategoryModel:
      return IsCategoryModelFile(std::as_bytes(std::span(head))) ||
             IsChannelModelFile(std::as_bytes(std::span(head))) || IsDetectorFile(std::as_bytes(std::span(head)));
    case FileKind::kSimulation:
      return IsSimulationFolder(path.parent_path());
    case FileKind::kVideo:
      return false;
    case FileKind::kReport:
      break;
  }
  return IsReport(head);
}

Status CheckKind(const OutputFile& output, const struct stat& existing) {
  if (std::holds_alternative<std::monostate>(output.kind) || !S_ISREG(existing.st_mode) || existing.st_size == 0) {
    return {};
  }
  std::error_code failed;
  const std::string head = ReadHead(output.path, failed);
  if (failed) return std::unexpected(ErrorFromErrno(failed.value(), output.path));
  const auto* const format = std::get_if<const ExportFormat*>(&output.kind);
  const auto* const kind = std::get_if<FileKind>(&output.kind);
  if (format != nullptr ? (*format)->is_file(head) : IsOfKind(*kind, output.path, head)) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{} {}: exists and is not {}: give another name, or --force to replace it", output.flag,
                          output.path, format != nullptr ? (*format)->file : ToText(kKindTexts, *kind)));
}

// An option whose values are paths of inputs, by the name of its value. Positional arguments are paths except NAME.
bool NamesPaths(const CLI::Option& option) {
  if (option.get_name() == "--files-below") return false;  // a limit: what lies there is not read for that
  constexpr std::array<std::string_view, 5> kTypes = {"FILE", "DIR", "DB", "CSV", "SCENE.json"};
  if (option.get_positional()) return option.get_name() != "NAME";
  return std::ranges::find(kTypes, option.get_type_name()) != kTypes.end();
}

struct InputPath {
  std::string option;  ///< that names it; empty: found by the command itself
  fs::path path;
};

std::vector<InputPath> ListInputs(const CLI::App& command, const std::vector<OutputFile>& outputs,
                                  const std::vector<std::string>& further_inputs) {
  std::vector<InputPath> inputs;
  for (const CLI::Option* option : command.get_options()) {
    const bool is_output = std::ranges::find(outputs, option->get_name(), &OutputFile::flag) != outputs.end();
    if (is_output || !NamesPaths(*option)) continue;
    for (const std::string& value : option->results()) inputs.push_back({option->get_name(), value});
  }
  for (const std::string& path : further_inputs) inputs.push_back({"", path});
  return inputs;
}

bool IsSameFile(const fs::path& path, const struct stat& file) {
  struct stat info{};
  return ::stat(path.c_str(), &info) == 0 && info.st_dev == file.st_dev && info.st_ino == file.st_ino;
}

// The file of the input that `file` is: the input itself, a part of an index in use, or a file in the folder.
std::optional<fs::path> FindSameFile(const InputPath& input, const struct stat& file) {
  std::error_code unknown;
  if (!fs::is_directory(input.path, unknown)) {
    for (const char* part : {"", "-wal", "-shm", "-journal"}) {
      fs::path path = input.path.string() + part;
      if (IsSameFile(path, file)) return path;
    }
    return std::nullopt;
  }
  for (const fs::path& path : ListFolder(input.path).value_or(std::vector<fs::path>())) {
    const bool is_read = input.option != "--models" || path.extension() == ".vmodel";
    if (is_read && IsSameFile(path, file)) return path;
  }
  return std::nullopt;
}

// The absolute path of a file that need not exist: symbolic links are resolved, those to nothing included.
fs::path ResolvePath(fs::path path) {
  constexpr int kMaxLinks = 40;
  std::error_code failed;
  for (int links = 0; links < kMaxLinks && fs::is_symlink(path, failed); ++links) {
    path = path.parent_path() / fs::read_symlink(path, failed);
  }
  const fs::path resolved = fs::weakly_canonical(fs::absolute(path, failed), failed);
  return failed ? path.lexically_normal() : resolved;
}

// True if writing one output would replace the other. A device or a pipe may take both.
bool IsSameOutput(const OutputFile& one, const OutputFile& other) {
  if (IsStandardOutput(one.path) || IsStandardOutput(other.path)) return false;
  struct stat existing{};
  if (::stat(one.path.c_str(), &existing) == 0) {
    return !S_ISCHR(existing.st_mode) && !S_ISFIFO(existing.st_mode) && IsSameFile(other.path, existing);
  }
  return ResolvePath(one.path) == ResolvePath(other.path);
}

Status CheckDifferent(const std::vector<OutputFile>& outputs) {
  for (auto one = outputs.begin(); one != outputs.end(); ++one) {
    const auto other =
        std::find_if(outputs.begin(), one, [&](const auto& before) { return IsSameOutput(before, *one); });
    if (other == one) continue;
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{} {}: is the same file as {} {}: give another name",
                                                         one->flag, one->path, other->flag, other->path));
  }
  return {};
}

}  // namespace

void AddForce(ArgumentParser& command) {
  command.AddFlag("--force", "Replace an existing output file even if it is of another kind");
}

std::vector<std::string> ListTelemetryBeside(const std::vector<std::string>& videos,
                                             const std::optional<std::string>& telemetry) {
  std::vector<std::string> files;
  if (telemetry) return files;
  for (const std::string& video : videos) {
    if (const std::optional<fs::path> file = FindTelemetryFile(video)) files.push_back(file->string());
  }
  return files;
}

Status CheckOutputs(const ArgumentParser& command, const std::vector<OutputFile>& outputs,
                    const std::vector<std::string>& further_inputs) {
  const CLI::Option* force = command.app().get_option_no_throw("--force");
  const std::vector<InputPath> inputs = ListInputs(command.app(), outputs, further_inputs);
  VICTORIOUS_RETURN_IF_ERROR(CheckDifferent(outputs));
  for (const OutputFile& output : outputs) {
    struct stat existing{};
    if (IsStandardOutput(output.path) || ::stat(output.path.c_str(), &existing) != 0) continue;
    if (S_ISCHR(existing.st_mode)) continue;  // /dev/null and the terminal may be both
    for (const InputPath& input : inputs) {
      const std::optional<fs::path> same = FindSameFile(input, existing);
      if (!same) continue;
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} {}: is an input of the same command ({}{}{}): give another name", output.flag,
                              output.path, input.option, input.option.empty() ? "" : " ", same->string()));
    }
    if (force == nullptr || force->count() == 0) VICTORIOUS_RETURN_IF_ERROR(CheckKind(output, existing));
  }
  return {};
}

}  // namespace victorious::cli
