// Fuzzes the readers of what other programs found: they give boxes that are finite, with an area, of a class that is
// there, or fail with a one-line error.
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/base/check.h"
#include "victorious/category/finder/detection_list.h"

namespace {

using victorious::DetectionList;

void CheckList(const DetectionList& list) {
  for (const auto& [frame, boxes] : list.frames) {
    VICTORIOUS_CHECK(frame >= 0 && !boxes.empty());
    for (const victorious::ListedBox& one : boxes) {
      VICTORIOUS_CHECK(one.category < list.classes.size());
      VICTORIOUS_CHECK(one.score >= 0 && one.score <= 1);
      VICTORIOUS_CHECK(std::isfinite(one.box.x) && std::isfinite(one.box.y));
      VICTORIOUS_CHECK(one.box.width > 0 && one.box.height > 0 && std::isfinite(one.box.Area()));
    }
  }
}

void CheckResult(const victorious::Expected<DetectionList>& list) {
  if (list) return CheckList(*list);
  VICTORIOUS_CHECK(list.error().message.find('\n') == std::string::npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::vector<std::string> names = {"car", "truck"};
  CheckResult(victorious::ParseCocoDetections(text, "d.json", "v.mp4", names));
  CheckResult(victorious::ParseMotDetections(text, "d.txt", names));
  DetectionList list{.is_relative = true};
  const victorious::Status labels = victorious::ParseYoloLabels(text, "v_1.txt", 1, names, list);
  if (!labels) VICTORIOUS_CHECK(labels.error().message.find('\n') == std::string::npos);
  CheckList(list);
  return 0;
}

std::vector<std::string> FuzzSeeds() {
  return {"",
          R"({"categories":[{"id":3,"name":"car"}],"images":[{"id":1,"frame_index":4}],)"
          R"("annotations":[{"image_id":1,"category_id":3,"bbox":[1,2,30,40],"score":0.7,"track_id":5}]})",
          R"({"videos":[{"id":1,"name":"v.mp4"},{"id":2}],"images":[{"id":1,"video_id":1,"file_name":"a_12.png"},)"
          R"({"id":2,"video_id":2,"file_name":"b_3.png"}],"annotations":[{"image_id":1,"bbox":[1,2,3,4]}]})",
          R"([{"image_id":3,"category_id":2,"bbox":[1,2,3,4],"score":1.5}])",
          "1,7,10,20,30,40,0.5,-1,-1,-1\r\n2,-1,1,2,3,4,-1,-1,-1,-1\n",
          "1,1,1,1,2,2,1,2,1\n1,2,1,1,2,2,0,1,1\n",
          "0 0.5 0.5 0.2 0.1 0.75\n1 0.5 0.5 0.2 0.1 0.5 3\n"};
}
