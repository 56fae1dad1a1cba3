// Reads the frames of one segment of a video, with the numbers that they have in the whole video.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "victorious/base/error.h"
#include "victorious/input/video/video_reader.h"
#include "victorious/store/segment_store.h"

namespace victorious {

/// A VideoReader of some frames. It enters the stream at the key frame before them; where that gives other frames than
/// the list of times, it reads from the beginning.
class SegmentReader final : public VideoReader {
 public:
  /// @param times_s  of all frames of the video (ReadFrameTable); outlive the reader
  /// @param frames   are read
  /// Errors: those of VideoReader::Open; kInvalidArgument for a live source.
  [[nodiscard]] static Expected<std::unique_ptr<SegmentReader>> Open(const std::string& source,
                                                                     const VideoReaderOptions& options,
                                                                     std::span<const double> times_s,
                                                                     FrameInterval frames);

  /// False if a frame was not the one of the list, or damaged: the decoded video is another than the list says, and
  /// numbers of frames are those of the whole video only if it is read as a whole. NextFrame has ended there.
  [[nodiscard]] bool IsExact() const { return is_exact_ && !reader_->has_damage(); }

  [[nodiscard]] const VideoInfo& info() const override { return info_; }
  [[nodiscard]] Expected<std::string> ContentId(const CancelToken& cancel,
                                                const ByteProgress& progress) const override {
    return reader_->ContentId(cancel, progress);
  }
  [[nodiscard]] Expected<std::optional<Frame>> NextFrame() override;
  std::vector<DataPacket> TakeDataPackets() override { return reader_->TakeDataPackets(); }
  bool SeekTo(double /*time_s*/) override { return false; }
  void SkipToEnd() override { next_ = frames_.to; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return reader_->warnings(); }
  [[nodiscard]] const std::vector<std::string>& notes() const override { return reader_->notes(); }

 private:
  SegmentReader(std::unique_ptr<VideoReader> reader, std::span<const double> times_s, FrameInterval frames);
  /// Reads up to the first frame of the segment, and keeps it. Returns false if it does not come.
  [[nodiscard]] Expected<bool> FindFirst();
  [[nodiscard]] double TimeOf(std::int64_t frame) const { return times_s_[static_cast<std::size_t>(frame)]; }

  std::unique_ptr<VideoReader> reader_;
  std::span<const double> times_s_;
  FrameInterval frames_;
  VideoInfo info_;
  std::int64_t next_;
  std::optional<Frame> first_;
  bool is_exact_ = true;
};

}  // namespace victorious
