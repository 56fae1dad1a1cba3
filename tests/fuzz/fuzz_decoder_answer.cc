// Fuzzes what the server reads of a decoder's answers: the process that writes them may have been taken over. The first
// byte chooses the kind.
#include <string_view>

#include "tests/fuzz/fuzz_target.h"
#include "victorious/apps/decoder/frame_request.h"
#include "victorious/base/check.h"
#include "victorious/base/packed_bytes.h"
#include "victorious/place/cameras/camera_request.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view answer(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 3) {
    case 0: {
      const auto times_s = victorious::UnpackTimes(answer);
      VICTORIOUS_CHECK(!times_s || victorious::PackTimes(*times_s) == answer);
      return 0;
    }
    case 1: {
      const auto grey = victorious::UnpackGrey(answer);
      VICTORIOUS_CHECK(!grey || victorious::PackGrey(*grey) == answer);
      return 0;
    }
    default: {
      const auto cameras = victorious::UnpackCameraAnswer(answer, {});
      if (cameras && cameras->HasStates()) static_cast<void>(cameras->At(0.5));
      return 0;
    }
  }
}

std::vector<std::string> FuzzSeeds() {
  const cv::Mat grey(2, 3, CV_8UC1, cv::Scalar(7));
  std::vector<std::string> seeds = {'\0' + victorious::PackTimes({0, 0.04, 0.08}), '\1' + victorious::PackGrey(grey)};
  victorious::ByteWriter writer;
  writer.Put(std::uint64_t{0});  // warnings
  victorious::CameraStates().Pack(writer);
  const std::vector<std::byte> none = writer.Take();
  seeds.push_back('\2' + std::string(reinterpret_cast<const char*>(none.data()), none.size()));
  return seeds;
}
