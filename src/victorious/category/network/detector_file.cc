#include "victorious/category/network/detector_file.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/file.h"
#include "victorious/base/json.h"
#include "victorious/base/one_line.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/base/sealed_bytes.h"
#include "victorious/base/text.h"
#include "victorious/category/network/output_layout.h"

namespace victorious {
namespace {

constexpr FileMagic kDetectorMagic = {0x8A, 'V', 'D', 'E', 'T', 0x0D, 0x0A, 0x1A};
constexpr std::uint32_t kDetectorVersion = 1;

Error Damaged(const std::string& name, const char* how) {
  return {ErrorCode::kDataLoss,
          fmt::format("{}: a damaged detector ({}): import it again with `victorious category import`", name, how)};
}

Status CheckClasses(const std::vector<std::string>& classes) {
  if (classes.empty() || classes.size() > kMaxDetectorClasses) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} classes: must be 1 to {}, one name a line", classes.size(), kMaxDetectorClasses));
  }
  std::set<std::string_view> seen;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (const Status named = CheckClassName(classes[i]); !named) {
      return Fail(named.error().code, fmt::format("line {}: {}", i + 1, named.error().message));
    }
    if (!seen.insert(classes[i]).second) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("line {}: the class {} comes twice: names must differ", i + 1, classes[i]));
    }
  }
  return {};
}

// The texts of a detector's description; std::nullopt if it is none.
std::optional<DetectorModel> ParseDescription(std::string_view text) {
  const Expected<nlohmann::json> json = ParseStrictJson(text);
  if (!json || !json->is_object()) return std::nullopt;
  DetectorModel model;
  const auto read_text = [&](const char* key, std::string& to) {
    const auto found = json->find(key);
    if (found == json->end() || !found->is_string()) return false;
    to = found->get<std::string>();
    return true;
  };
  const auto classes = json->find("classes");
  const auto settings = json->find("settings");
  if (!read_text("program_version", model.program_version) || !read_text("source", model.source) ||
      !read_text("trained_on", model.trained_on) || classes == json->end() || !classes->is_array() ||
      settings == json->end()) {
    return std::nullopt;
  }
  for (const nlohmann::json& name : *classes) {
    if (!name.is_string()) return std::nullopt;
    model.classes.push_back(name.get<std::string>());
  }
  FieldList fields;
  model.settings.ListFields(fields);
  if (!CheckClasses(model.classes) || !SetFromJson(*settings, fields.fields())) return std::nullopt;
  return model;
}

std::string Describe(const DetectorModel& model) {
  DetectorSettings settings = model.settings;
  FieldList fields;
  settings.ListFields(fields);
  return DumpJson(nlohmann::json{{"program_version", model.program_version},
                                 {"source", model.source},
                                 {"trained_on", model.trained_on},
                                 {"classes", model.classes},
                                 {"settings", ToJson(fields.fields())}});
}

}  // namespace

Status CheckClassName(std::string_view name) {
  constexpr std::size_t kMaxBytes = 100;
  constexpr char kDelete = 0x7f;
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == kDelete; };
  if (name.empty() || name.size() > kMaxBytes || std::ranges::any_of(name, is_control)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("a class must have a name of 1 to {} bytes without control characters", kMaxBytes));
  }
  return {};
}

Expected<std::vector<std::string>> ParseClassList(std::string_view text, const std::string& name_for_errors) {
  std::vector<std::string> classes;
  std::string_view rest = StripByteOrderMark(text);
  while (!rest.empty() && classes.size() <= kMaxDetectorClasses) {
    classes.emplace_back(TrimBlanks(TakeLine(rest)));
  }
  while (!classes.empty() && classes.back().empty()) classes.pop_back();
  if (Status valid = CheckClasses(classes); !valid) {
    return std::unexpected(std::move(valid).error().WithContext(name_for_errors));
  }
  for (std::string& name : classes) name = ReplaceInvalidUtf8(name);
  return classes;
}

Expected<std::vector<std::string>> ReadClassList(const std::string& path) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 21;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxBytes));
  return ParseClassList(text, OneLine(path));
}

bool IsDetectorFile(std::span<const std::byte> bytes) { return HasMagic(bytes, kDetectorMagic); }

std::vector<std::byte> EncodeDetector(const DetectorModel& model) {
  ByteWriter writer;
  writer.PutText(Describe(model));
  writer.PutText(model.files.network);
  writer.PutText(model.files.weights);
  return Seal(kDetectorMagic, kDetectorVersion, writer.Take());
}

Status WriteDetector(const std::filesystem::path& path, const DetectorModel& model) {
  return WriteFileAtomically(path, EncodeDetector(model));
}

Expected<DetectorModel> ReadDetector(const std::filesystem::path& path) {
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, 2 * kMaxNetworkBytes));
  return ParseDetector(std::as_bytes(std::span(bytes)), path.string());
}

Expected<DetectorModel> ParseDetector(std::span<const std::byte> bytes, const std::string& name_for_errors) {
  if (!IsDetectorFile(bytes)) {
    return Fail(ErrorCode::kDataLoss,
                fmt::format("{}: not a detector: `victorious category import` makes one", name_for_errors));
  }
  const std::optional<SealedHeader> header = ReadSealedHeader(bytes);
  if (!header) return std::unexpected(Damaged(name_for_errors, "it ends in its header"));
  if (header->version != kDetectorVersion) {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("{}: a detector of format {}, not {}: import it again with this version", name_for_errors,
                            header->version, kDetectorVersion));
  }
  const std::span<const std::byte> payload = PayloadOf(bytes);
  if (const char* fault = FaultOfPayload(*header, payload)) return std::unexpected(Damaged(name_for_errors, fault));
  ByteReader reader(payload);
  std::optional<DetectorModel> model = ParseDescription(reader.GetText());
  if (!model) return std::unexpected(Damaged(name_for_errors, "its description cannot be read"));
  model->files.network = reader.GetText();
  model->files.weights = reader.GetText();
  if (!reader.IsAtEnd()) return std::unexpected(Damaged(name_for_errors, "its network cannot be read"));
  return *std::move(model);
}

}  // namespace victorious
