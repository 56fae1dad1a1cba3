#include "victorious/lab/evaluate/reported.h"

#include "victorious/store/catalogue.h"

namespace victorious {

Expected<ReportedContent> ReadReported(IndexStore& store, const SightingFilter& filter) {
  VICTORIOUS_ASSIGN_OR_RETURN(const Catalogue catalogue, Catalogue::Read(store, filter));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<ObjectRecord> objects, store.Objects(filter));
  VICTORIOUS_ASSIGN_OR_RETURN(const std::vector<SightingRecord> sightings, store.Sightings(filter));
  ReportedContent reported;
  for (const ObjectRecord& object : objects) {
    const ModelRecord* model = catalogue.Model(object.model);
    if (model != nullptr && !model->IsCategory()) {
      reported.objects.push_back({object.id, object.place, object.heading_rad, object.score});
    }
  }
  for (const SightingRecord& row : sightings) {
    const ModelRecord* model = catalogue.Model(row.model);
    if (model == nullptr || model->IsCategory()) continue;  // added by another process after the catalogue was read
    reported.sightings.push_back({.object = row.object,
                                  .frame = row.frame,
                                  .model = model->name,
                                  .box = row.box,
                                  .score = row.score,
                                  .view = row.view});
  }
  return reported;
}

}  // namespace victorious
