#include "victorious/category/common/category_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "victorious/base/file.h"
#include "victorious/base/text.h"

namespace victorious {
namespace {

constexpr std::array<std::string_view, 4> kBoxColumns = {"x0", "y0", "x1", "y1"};

std::optional<double> ParsePixels(std::string_view text) {
  constexpr double kFarthestPx = 1e7;
  const auto number = ParseNumber(text);
  return number && std::abs(*number) < kFarthestPx ? number : std::nullopt;
}

using Fields = std::map<std::string_view, std::string>;

Expected<std::optional<Box>> ParseBox(const Fields& fields, const std::string& where) {
  std::array<double, 4> edges{};
  std::string written;
  int given = 0;
  bool numbers = true;
  for (std::size_t i = 0; i < kBoxColumns.size(); ++i) {
    const auto field = fields.find(kBoxColumns[i]);
    const std::string text = field == fields.end() ? "" : field->second;
    written += (i > 0 ? "," : "") + text;
    if (text.empty()) continue;
    ++given;
    const auto number = ParsePixels(text);
    numbers = numbers && number.has_value();
    edges[i] = number.value_or(0);
  }
  if (given == 0) return std::nullopt;
  const auto fail = [&](std::string_view what) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: box {} {}", where, written, what));
  };
  if (given < 4 || !numbers) return fail("must be four numbers x0,y0,x1,y1 in pixels, or empty for the whole image");
  const Box box{edges[0], edges[1], edges[2] - edges[0], edges[3] - edges[1]};
  if (box.IsEmpty()) return fail("is empty: x1 must be above x0, and y1 above y0");
  return box;
}

Expected<CategoryListRow> ParseRow(const Fields& fields, std::string where) {
  const auto text = [&](std::string_view column) {
    const auto field = fields.find(column);
    return field == fields.end() ? std::string() : field->second;
  };
  CategoryListRow row{
      .image = text("image"), .category = text("category"), .box = {}, .mark = {}, .where = std::move(where)};
  if (row.image.empty())
    return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: no image: must be the path of an image", row.where));
  if (const std::string mark = text("mark"); !mark.empty()) {
    row.mark = FromText(kFeedbackMarkTexts, mark);
    if (!row.mark)
      return Fail(ErrorCode::kInvalidArgument, fmt::format("{}: mark {}: must be right or wrong", row.where, mark));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(row.box, ParseBox(fields, row.where));
  return row;
}

}  // namespace

Expected<std::vector<CategoryListRow>> ParseCategoryList(std::string_view text, const std::string& name_for_errors) {
  text = StripByteOrderMark(text);
  std::vector<std::string> columns;
  std::vector<CategoryListRow> rows;
  for (int number = 1; !text.empty(); ++number) {
    const std::string_view line = TrimBlanks(TakeLine(text));
    if (line.empty()) continue;
    const std::vector<std::string> values = SplitRow(line);
    if (columns.empty()) {
      columns = values;
      if (std::ranges::find(columns, "image") == columns.end())
        return Fail(ErrorCode::kInvalidArgument,
                    fmt::format("{}: no column image: the first line must name the columns, as in "
                                "image,category,x0,y0,x1,y1",
                                name_for_errors));
      continue;
    }
    Fields fields;
    for (std::size_t i = 0; i < std::min(values.size(), columns.size()); ++i) fields[columns[i]] = values[i];
    VICTORIOUS_ASSIGN_OR_RETURN(CategoryListRow row,
                                ParseRow(fields, fmt::format("{} line {}", name_for_errors, number)));
    rows.push_back(std::move(row));
  }
  if (rows.empty())
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no images: must have a header and one line per image", name_for_errors));
  return rows;
}

Expected<std::vector<CategoryListRow>> ReadCategoryList(const std::filesystem::path& path) {
  constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxBytes));
  return ParseCategoryList(text, path.string());
}

Expected<Box> ClippedBox(const CategoryListRow& row, int width_px, int height_px) {
  const Box whole = FrameBox(width_px, height_px);
  if (!row.box) return whole;
  const Box inside = Intersection(*row.box, whole);
  if (!inside.IsEmpty()) return inside;
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{}: box {:g},{:g},{:g},{:g} lies outside the image, which is {} x {} px", row.where, row.box->x,
                  row.box->y, row.box->x + row.box->width, row.box->y + row.box->height, width_px, height_px));
}

}  // namespace victorious
