// The routes of thresholds: what the decisions about each model's objects suggest, and what is in force. Thread-safe.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "victorious/apps/serve/index_view.h"
#include "victorious/apps/serve/once_cache.h"
#include "victorious/apps/serve/route_table.h"
#include "victorious/store/threshold_store.h"

namespace victorious {

class ThresholdRoutes {
 public:
  /// @param thresholds  takes what is put into force; readers have their own
  ThresholdRoutes(IndexView& index, std::unique_ptr<ThresholdStore> thresholds);

  ApiExpected<HttpResponse> List(const ApiCall& call);
  ApiExpected<HttpResponse> Put(const ApiCall& call);

 private:
  /// The body of the answer, made once for all that ask for it between two changes.
  [[nodiscard]] Expected<std::shared_ptr<const std::string>> CurrentList();
  [[nodiscard]] Expected<std::string> MakeList(const IndexLists& lists);

  IndexView& index_;
  std::mutex mutex_;
  std::unique_ptr<ThresholdStore> thresholds_;
  OnceCache<std::string> lists_;  ///< bodies of answers, by the lists and IndexView::own_changes
};

}  // namespace victorious
