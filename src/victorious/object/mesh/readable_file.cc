#include "victorious/object/mesh/readable_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/base/text.h"
#include "victorious/object/mesh/simplify_gltf.h"

namespace victorious {
namespace {

constexpr std::string_view kBlanks = " \t";

// The next word of a line; empty at its end.
std::string_view TakeWord(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

Expected<ReadableFile> ReadableGltf(const CadFolder& folder) {
  ReadableFile file;
  std::optional<GltfFile> gltf = GltfFile::Read(folder);
  if (!gltf) return file;
  const nlohmann::json before = gltf->document();
  VICTORIOUS_ASSIGN_OR_RETURN(file.warnings, SimplifyGltf(*gltf));
  if (gltf->document() != before) file.rewritten = gltf->Write();
  return file;
}

using Coordinates = std::array<double, 3>;

// Of a line "v x y z …"; `line` is left with what follows.
std::optional<Coordinates> TakeVertex(std::string_view& line) {
  if (TakeWord(line) != "v") return std::nullopt;
  Coordinates vertex{};
  for (double& value : vertex) {
    const auto number = TakeNumber(line);
    if (!number) return std::nullopt;
    value = *number;
  }
  return vertex;
}

// The first vertex in whole units, if it is of a map.
std::optional<Coordinates> MapOffset(std::string_view text) {
  while (!text.empty()) {
    std::string_view line = TakeLine(text);
    auto vertex = TakeVertex(line);
    if (!vertex) continue;
    bool is_of_map = false;
    for (double& value : *vertex) {
      is_of_map = is_of_map || std::abs(value) >= kMapCoordinate;
      value = std::round(value);
    }
    return is_of_map ? vertex : std::nullopt;
  }
  return std::nullopt;
}

std::string MovedToOrigin(std::string_view text, const Coordinates& offset) {
  std::string moved;
  moved.reserve(text.size());
  while (!text.empty()) {
    const std::string_view line = TakeLine(text);
    std::string_view rest = line;
    if (const auto vertex = TakeVertex(rest)) {
      moved += fmt::format("v {} {} {}{}\n", (*vertex)[0] - offset[0], (*vertex)[1] - offset[1],
                           (*vertex)[2] - offset[2], rest);
    } else {
      moved.append(line).push_back('\n');
    }
  }
  return moved;
}

Expected<ReadableFile> ReadableObj(const CadFolder& folder) {
  ReadableFile file;
  const std::string_view text = StripByteOrderMark(folder.text());
  if (text.size() < folder.text().size()) file.rewritten = std::string(text);
  for (std::string_view rest = text; !rest.empty();) {
    std::string_view line = TakeLine(rest);
    if (TakeWord(line) != "mtllib") continue;
    const std::string_view name = TrimBlanks(line);
    if (!name.empty() && !folder.Find(name))
      file.warnings.push_back(
          fmt::format("{}: no such file in the CAD file's folder: without colours and textures", name));
  }
  if (const auto offset = MapOffset(text)) file.rewritten = MovedToOrigin(text, *offset);
  return file;
}

// The importer skips all line feeds after the header; one that ends in CR LF it takes as it is.
Expected<ReadableFile> ReadablePly(const CadFolder& folder) {
  ReadableFile file;
  std::string header;
  std::string_view rest = folder.text();
  bool is_binary = false;
  bool is_ended = false;
  bool is_face = false;
  std::int64_t faces = 0;
  while (!rest.empty() && !is_ended) {
    const std::string_view line = TakeLine(rest);
    std::string_view words = line;
    const std::string_view first = TakeWord(words);
    const std::string_view second = TakeWord(words);
    is_ended = first == "end_header";
    is_binary = is_binary || (first == "format" && second.starts_with("binary"));
    if (first == "element") {
      is_face = second == "face" || second == "tristrips";
      if (is_face) faces = ParseInteger(TakeWord(words)).value_or(0);
    }
    const std::string_view name = TakeWord(words);
    constexpr std::string_view kDiffuse = "diffuse_";
    if (is_ended && is_binary) {
      header.append("end_header\r\n");
    } else if (first == "property" && name.starts_with(kDiffuse)) {
      header += fmt::format("property {} {}\n", second, name.substr(kDiffuse.size()));
    } else {
      header.append(line).push_back('\n');
    }
    if (first == "property" && is_face && (name == "red" || name == "diffuse_red"))
      file.warnings.emplace_back("colours of faces are left out: give the vertices their colours");
  }
  if (!folder.text().starts_with("ply") || folder.text().find("end_header") == std::string::npos)
    return Fail(ErrorCode::kDataLoss, "damaged, or not a PLY file: the header has no end_header");
  if (!is_ended) return file;  // of lines that end otherwise
  if (faces == 0) return Fail(ErrorCode::kUnsupported, "a point cloud: it has no faces; make a mesh of it first");
  header.append(rest);
  file.rewritten = std::move(header);
  return file;
}

}  // namespace

Expected<ReadableFile> MakeReadable(const CadFolder& folder, CadFormat format) {
  switch (format) {
    case CadFormat::kGltf:
      return ReadableGltf(folder);
    case CadFormat::kObj:
      return ReadableObj(folder);
    case CadFormat::kPly:
      return ReadablePly(folder);
    default:
      return ReadableFile{};
  }
}

}  // namespace victorious
