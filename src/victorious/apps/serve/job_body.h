// What the bodies of all requests for jobs have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "victorious/apps/serve/api_error.h"

namespace victorious {

/// Checks that a body has no members but these. Error: kInvalidArgument with the member's name as its field.
[[nodiscard]] ApiStatus CheckMembers(const nlohmann::json& body, std::initializer_list<std::string_view> names);

/// Whether a job of the kind "live" may open this address: that of a source that sends by itself.
[[nodiscard]] bool IsLiveSource(std::string_view url);

/// The whole number under a name; -1 if there is none.
[[nodiscard]] std::int64_t ReadNumber(const nlohmann::json& body, std::string_view name);

/// The text under a name. Error: kInvalidArgument.
[[nodiscard]] ApiExpected<std::string> ReadText(const nlohmann::json& body, const std::string& name);

/// The member "frame". Error: kInvalidArgument unless it is a whole number from 0 to `frames` - 1.
[[nodiscard]] ApiExpected<std::int64_t> ReadFrame(const nlohmann::json& body, std::int64_t frames);

/// Checks the member "box": x, y, width and height, px, the sizes above 0. Error: kInvalidArgument.
[[nodiscard]] ApiStatus CheckBox(const nlohmann::json& body);

/// Checks the member "boxes": one such box for each photo. Error: kInvalidArgument.
[[nodiscard]] ApiStatus CheckBoxes(const nlohmann::json& body, std::size_t photos);

}  // namespace victorious
