#include "victorious/category/common/category_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace victorious {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(CategoryList, ReadsColumnsByName) {
  const auto rows = ParseCategoryList(
      "\xEF\xBB\xBF"
      "category,image,x0,y0,x1,y1\r\nplane,a.jpg,1,2,30,40\r\n\nplane,\"b, c.jpg\",,,,\nplane,d.jpg\n",
      "l");
  ASSERT_TRUE(rows.has_value()) << rows.error().message;
  ASSERT_EQ(rows->size(), 3U);
  EXPECT_EQ((*rows)[0].image, "a.jpg");
  EXPECT_EQ((*rows)[0].category, "plane");
  EXPECT_EQ((*rows)[0].box, (Box{1, 2, 29, 38}));
  EXPECT_EQ((*rows)[1].image, "b, c.jpg");
  EXPECT_FALSE((*rows)[1].box.has_value());
  EXPECT_EQ((*rows)[2].where, "l line 5");
}

TEST(CategoryList, ReadsUserMarks) {
  const auto rows = ParseCategoryList("image,mark\na.jpg,right\nb.jpg,wrong\nc.jpg,\n", "l");
  ASSERT_TRUE(rows.has_value()) << rows.error().message;
  EXPECT_EQ((*rows)[0].mark, FeedbackMark::kRight);
  EXPECT_EQ((*rows)[1].mark, FeedbackMark::kWrong);
  EXPECT_EQ((*rows)[2].mark, std::nullopt);
}

std::string Refusal(const std::string& text) {
  const auto rows = ParseCategoryList(text, "list.csv");
  return rows ? "accepted" : rows.error().message;
}

TEST(CategoryList, ErrorsNameTheLine) {
  const std::string header = "image,category,x0,y0,x1,y1\n";
  EXPECT_THAT(Refusal(""), HasSubstr("no images"));
  EXPECT_THAT(Refusal(header), HasSubstr("no images"));
  EXPECT_THAT(Refusal("a.jpg,plane\n"), HasSubstr("no column image"));
  EXPECT_THAT(Refusal(header + "a.jpg,plane,10,10,10,50\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("10,10,10,50 is empty")));
  EXPECT_THAT(Refusal(header + "a.jpg,plane,10,10,50\n"), HasSubstr("four numbers"));
  EXPECT_THAT(Refusal(header + "a.jpg,plane,10,ten,50,50\n"), HasSubstr("four numbers"));
  EXPECT_THAT(Refusal(header + "a.jpg,plane,0,0,nan,1e99\n"), HasSubstr("four numbers"));
  EXPECT_THAT(Refusal(header + ",plane\n"), HasSubstr("no image"));
  EXPECT_THAT(Refusal("image,mark\na.jpg,maybe\n"), HasSubstr("right or wrong"));
}

TEST(CategoryList, BoxesAreClippedToTheImage) {
  CategoryListRow row{
      .image = "a.jpg", .category = "plane", .box = Box{-5, 10, 20, 200}, .mark = {}, .where = "l line 2"};
  EXPECT_EQ(*ClippedBox(row, 100, 50), (Box{0, 10, 15, 40}));
  row.box = Box{100, 0, 10, 10};
  EXPECT_THAT(ClippedBox(row, 100, 50).error().message,
              AllOf(HasSubstr("l line 2"), HasSubstr("outside"), HasSubstr("100 x 50")));
  row.box.reset();
  EXPECT_EQ(*ClippedBox(row, 100, 50), (Box{0, 0, 100, 50}));
}

}  // namespace
}  // namespace victorious
