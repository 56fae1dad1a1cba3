#include "victorious/video.h"

#include <utility>

#include "victorious/apps/library/facade.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/types/frame.h"

namespace libvictorious {

struct Frame::Impl {
  victorious::Frame frame;
};

std::int64_t Frame::index() const noexcept { return impl_->frame.index; }
double Frame::time_s() const noexcept { return impl_->frame.time_s; }
ImageView Frame::image() const noexcept { return ViewOf(impl_->frame.image); }

Frame::Frame(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Frame::Frame(const Frame& other) = default;
Frame::Frame(Frame&& other) noexcept = default;
Frame& Frame::operator=(const Frame& other) = default;
Frame& Frame::operator=(Frame&& other) noexcept = default;
Frame::~Frame() = default;

struct Video::Impl {
  std::unique_ptr<victorious::VideoReader> reader;
};

Video::Video(const std::string& source, const VideoSettings& settings) {
  Guard([&] {
    if (settings.format != PixelFormat::kGrey && settings.format != PixelFormat::kBgr) {
      throw Error(ErrorCode::kInvalidArgument, "frames are delivered as kGrey or kBgr: ask for one of them");
    }
    const bool is_grey = settings.format == PixelFormat::kGrey;
    victorious::VideoReaderOptions options;
    options.color = is_grey ? victorious::FrameColor::kGrey : victorious::FrameColor::kBgr;
    options.threads = settings.threads;
    options.folder_frame_rate = settings.folder_frame_rate;
    impl_ = std::make_unique<Impl>(Impl{.reader = Unwrap(victorious::VideoReader::Open(source, options))});
  });
}

Video::Video(Video&& other) noexcept = default;
Video& Video::operator=(Video&& other) noexcept = default;
Video::~Video() = default;

VideoInfo Video::info() const {
  const victorious::VideoInfo& info = impl_->reader->info();
  return {info.width, info.height, info.frame_rate, info.duration_s, info.frame_count, info.live, info.codec};
}

std::optional<Frame> Video::Next() {
  return Guard([&]() -> std::optional<Frame> {
    std::optional<victorious::Frame> frame = Unwrap(impl_->reader->NextFrame());
    if (!frame) return std::nullopt;
    return Frame(std::make_shared<const Frame::Impl>(Frame::Impl{*std::move(frame)}));
  });
}

bool Video::SeekTo(double time_s) {
  return Guard([&] { return impl_->reader->SeekTo(time_s); });
}

std::vector<std::string> Video::warnings() const { return impl_->reader->warnings(); }

}  // namespace libvictorious
