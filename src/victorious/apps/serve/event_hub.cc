#include "victorious/apps/serve/event_hub.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace victorious {

class EventHub::Listener final : public EventFeed {
 public:
  explicit Listener(std::shared_ptr<EventHub> hub) : hub_(std::move(hub)) {
    const std::scoped_lock lock(hub_->mutex_);
    ++hub_->listeners_;
  }
  ~Listener() override {
    const std::scoped_lock lock(hub_->mutex_);
    --hub_->listeners_;
  }

  std::string Take() override {
    const std::scoped_lock lock(hub_->mutex_);
    std::string text;
    const std::int64_t oldest = hub_->tail_.empty() ? hub_->next_ : hub_->tail_.front().number;
    if (next_ < oldest) {
      // New, or too slow: the latest event of each name says all that holds
      // now.
      std::vector<const Event*> latest;
      for (const auto& [name, event] : hub_->latest_) latest.push_back(&event);
      std::ranges::sort(latest, {}, &Event::number);
      for (const Event* event : latest) text += event->text;
    } else {
      for (const Event& event : hub_->tail_) {
        if (event.number >= next_) text += event.text;
      }
    }
    next_ = hub_->next_;
    return text;
  }

 private:
  std::shared_ptr<EventHub> hub_;
  std::int64_t next_ = 0;
};

void EventHub::Publish(std::string_view name, std::string_view json) {
  const std::scoped_lock lock(mutex_);
  Event event{.number = next_++, .text = {}};
  event.text = fmt::format("id: {}\nevent: {}\ndata: {}\n\n", event.number, name, json);
  tail_.push_back(event);
  if (tail_.size() > kKept) tail_.pop_front();
  latest_.insert_or_assign(std::string(name), std::move(event));
}

std::shared_ptr<EventFeed> EventHub::Listen() { return std::make_shared<Listener>(shared_from_this()); }

int EventHub::listeners() const {
  const std::scoped_lock lock(mutex_);
  return listeners_;
}

}  // namespace victorious
