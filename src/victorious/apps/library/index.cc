#include "victorious/index.h"

#include <filesystem>
#include <ostream>
#include <system_error>
#include <utility>

#include "victorious/apps/library/facade.h"
#include "victorious/base/file_writer.h"
#include "victorious/geometry/angles.h"
#include "victorious/show/export/export.h"
#include "victorious/show/export/listed_object.h"
#include "victorious/store/catalogue.h"
#include "victorious/store/open_store.h"
#include "victorious/types/ground_motion.h"

namespace libvictorious {
namespace {

using victorious::DegreesFromRadians;

static_assert(static_cast<int>(SightingSource::kTracked) == static_cast<int>(victorious::SightingSource::kTracked));

victorious::Expected<victorious::SightingFilter> FilterOf(const Filter& filter, victorious::IndexStore& store) {
  if (filter.model && filter.category) {
    return victorious::Fail(victorious::ErrorCode::kInvalidArgument,
                            "a filter of a model and of a category matches nothing: give one of them");
  }
  if (filter.from_s && filter.to_s && *filter.from_s > *filter.to_s) {
    return victorious::Fail(victorious::ErrorCode::kInvalidArgument, "from_s is after to_s: exchange them");
  }
  victorious::SightingFilter inner{.model_name = filter.model,
                                   .category_name = filter.category,
                                   .video_name = filter.video,
                                   .from_s = filter.from_s,
                                   .to_s = filter.to_s,
                                   .near = {},
                                   .include_rejected = filter.include_rejected,
                                   .object = filter.object,
                                   .without_weak = !filter.include_weak && !filter.object};
  // A name that the index does not have is an error.
  VICTORIOUS_RETURN_IF_ERROR(victorious::Catalogue::Read(store, inner));
  return inner;
}

Place PlaceOf(const victorious::Geolocation& place) {
  Place outer{.latitude_deg = DegreesFromRadians(place.point.latitude_rad),
              .longitude_deg = DegreesFromRadians(place.point.longitude_rad),
              .altitude_m = place.point.altitude_m,
              .time_s = place.time_s,
              .covariance_enu_m2 = {},
              .ce90_m = place.ce90_m,
              .le90_m = place.le90_m,
              .motion = std::nullopt};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      outer.covariance_enu_m2[static_cast<std::size_t>(3 * row + column)] = place.covariance_enu_m2(row, column);
    }
  }
  if (const auto motion = victorious::ComputeGroundMotion(place)) {
    outer.motion = Motion{.speed_m_s = motion->speed_m_s,
                          .sigma_speed_m_s = motion->sigma_speed_m_s,
                          .course_deg = DegreesFromRadians(motion->course_rad),
                          .sigma_course_deg = DegreesFromRadians(motion->sigma_course_rad)};
  }
  return outer;
}

Object ObjectOf(const victorious::ListedObject& listed) {
  const victorious::ObjectRecord& object = listed.object;
  Object outer{.id = object.id,
               .rank = static_cast<std::int64_t>(listed.rank),
               .model = listed.model,
               .is_category = listed.is_category,
               .score = object.score,
               .frames = object.frames,
               .place = object.place.transform(&PlaceOf),
               .heading_deg = object.heading_rad.transform(&DegreesFromRadians),
               .moments = {},
               .rejected = object.rejected,
               .place_rejected = object.place_rejected,
               .against = object.against};
  for (const victorious::ObjectMoment& moment : listed.moments) {
    outer.moments.push_back(
        {moment.video_name, moment.first_time_s, moment.last_time_s, moment.frames, moment.start_utc_us});
  }
  return outer;
}

Sighting SightingOf(const victorious::SightingRecord& record, const victorious::VideoRecord& video,
                    const victorious::ModelRecord& model) {
  const victorious::ObjectMoment moment{.start_utc_us = video.start_utc_us};
  return {.object = record.object,
          .model = model.name,
          .is_category = model.IsCategory(),
          .video = victorious::ShownName(video),
          .frame = record.frame,
          .time_s = record.time_s,
          .box = BoxOf(record.box),
          .outline = PointsOf(record.outline),
          .score = record.score,
          .source = static_cast<SightingSource>(record.source),
          .matches = model.IsCategory() ? 0 : record.matches,
          .distance_m = record.distance_m,
          .sigma_distance_m = record.sigma_distance_m,
          .utc_us = moment.UtcOf(record.time_s)};
}

}  // namespace

struct Index::Impl {
  std::string name;
  std::unique_ptr<victorious::IndexStore> store;
};

Index::Index(const std::string& name) {
  Guard([&] {
    impl_ = std::make_unique<Impl>(
        Impl{.name = name, .store = Unwrap(victorious::OpenStore(name, victorious::StoreMode::kRead))});
  });
}

Index::Index(Index&& other) noexcept = default;
Index& Index::operator=(Index&& other) noexcept = default;
Index::~Index() = default;

std::vector<IndexedVideo> Index::Videos() const {
  return Guard([&] {
    std::vector<IndexedVideo> videos;
    for (const victorious::VideoRecord& video : Unwrap(impl_->store->Videos())) {
      videos.push_back({victorious::ShownName(video), video.width, video.height, video.frame_count, video.duration_s,
                        video.start_utc_us});
    }
    return videos;
  });
}

std::vector<IndexedModel> Index::Models() const {
  return Guard([&] {
    std::vector<IndexedModel> models;
    for (const victorious::ModelRecord& model : Unwrap(impl_->store->Models())) {
      models.push_back({model.name, model.content_id, static_cast<ModelKind>(model.kind)});
    }
    return models;
  });
}

std::vector<Object> Index::Objects(const Filter& filter) const {
  return Guard([&] {
    const victorious::SightingFilter inner = Unwrap(FilterOf(filter, *impl_->store));
    const auto catalogue = Unwrap(victorious::Catalogue::Read(*impl_->store, inner));
    std::vector<Object> objects;
    for (const victorious::ListedObject& one : Unwrap(victorious::ListObjects(*impl_->store, catalogue, inner))) {
      objects.push_back(ObjectOf(one));
    }
    return objects;
  });
}

void Index::VisitSightings(const Filter& filter, const std::function<bool(const Sighting& sighting)>& visit) const {
  CallerCode caller;
  Guard([&] {
    const victorious::SightingFilter inner = Unwrap(FilterOf(filter, *impl_->store));
    const auto catalogue = Unwrap(victorious::Catalogue::Read(*impl_->store, inner));
    Unwrap(impl_->store->VisitSightings(inner, [&](victorious::SightingRecord&& record) {
      const victorious::VideoRecord* video = catalogue.Video(record.video);
      const victorious::ModelRecord* model = catalogue.Model(record.model);
      if (video == nullptr || model == nullptr) return true;  // added by another process since
      return caller.Run([&] { return visit(SightingOf(record, *video, *model)); });
    }));
  });
  caller.Rethrow();
}

std::vector<Sighting> Index::Sightings(const Filter& filter) const {
  std::vector<Sighting> sightings;
  VisitSightings(filter, [&](const Sighting& sighting) {
    sightings.push_back(sighting);
    return true;
  });
  return sightings;
}

void Index::Export(const std::string& format, const std::string& file, const Filter& filter) const {
  Guard([&] {
    const victorious::ExportFormat& parsed = *Unwrap(victorious::FindExportFormat(format));
    const victorious::SightingFilter inner = Unwrap(FilterOf(filter, *impl_->store));
    std::error_code unknown;
    if (std::filesystem::equivalent(file, impl_->name, unknown)) {
      Raise({.code = victorious::ErrorCode::kInvalidArgument,
             .message = file + ": is the index itself: give another file"});
    }
    Unwrap(victorious::WriteFileInParts(
        file, [&](std::ostream& out) { return victorious::Export(*impl_->store, parsed, inner, out); }));
  });
}

}  // namespace libvictorious
