// Parses the list of images to train on or to classify: CSV with a header, `image,category,x0,y0,x1,y1`; columns are
// identified by name, in any order. Classification needs only `image`; a row without a box stands for the whole image.
// For training, an image may also be a CAD file.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
#include "victorious/geometry/box.h"

namespace victorious {

/// The user's feedback on a result.
enum class FeedbackMark { kRight, kWrong };

inline constexpr auto kFeedbackMarkTexts =
    std::to_array<EnumText<FeedbackMark>>({{FeedbackMark::kRight, "right"}, {FeedbackMark::kWrong, "wrong"}});

struct CategoryListRow {
  std::string image;                 ///< path as written in the list, relative to the image folder
  std::string category;              ///< empty if not given
  std::optional<Box> box;            ///< px; has a positive area, but may lie outside the image
  std::optional<FeedbackMark> mark;  ///< column `mark`
  std::string where;                 ///< source position for messages: "list.csv line 7"
};

/// Parses the CSV text.
/// Errors: kInvalidArgument, with the line number, for a list without rows or without the column `image`, a row without
/// an image, a box that is not numeric, is empty or is incomplete, and a mark other than "right" and "wrong".
[[nodiscard]] Expected<std::vector<CategoryListRow>> ParseCategoryList(std::string_view text,
                                                                       const std::string& name_for_errors);

/// Reads and parses a list of at most 256 MiB. Errors: those of ReadFile and ParseCategoryList.
[[nodiscard]] Expected<std::vector<CategoryListRow>> ReadCategoryList(const std::filesystem::path& path);

/// Returns the row's box (px) clipped to an image of the given size, or the whole image if the row has no box.
/// Errors: kInvalidArgument for a box that lies entirely outside the image.
[[nodiscard]] Expected<Box> ClippedBox(const CategoryListRow& row, int width_px, int height_px);

}  // namespace victorious
