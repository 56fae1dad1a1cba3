// The list of pictures to train on or to classify: CSV with a header, `image,category,x0,y0,x1,y1`, columns by name in
// any order. Only `image` is needed to classify; a row without a box means the whole picture. To train, an image may be
// a CAD file, too.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/geometry/box.h"

namespace victorious {

struct CategoryListRow {
  std::string image;       ///< as written: relative to the folder of images
  std::string category;    ///< empty where not given
  std::optional<Box> box;  ///< px; not empty, though it may lie outside the picture
  std::string mark;        ///< "right", "wrong", or empty: what a user says of a result (column `mark`)
  std::string where;       ///< "list.csv line 7", for messages
};

/// Errors: kInvalidArgument, with the line, for a list without rows or without the column `image`, a row without an
/// image, boxes that are no numbers, are empty or have only some of the four numbers, and marks that are neither.
Expected<std::vector<CategoryListRow>> ParseCategoryList(std::string_view text, const std::string& name_for_errors);

Expected<std::vector<CategoryListRow>> ReadCategoryList(const std::filesystem::path& path);

/// The part of the row's box inside a picture; the whole picture where the row has none.
/// Errors: kInvalidArgument for a box that lies outside.
Expected<Box> BoxWithin(const CategoryListRow& row, int width_px, int height_px);

}  // namespace victorious
