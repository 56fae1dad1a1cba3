// What a fuzz target defines: one input run, and the valid inputs that mutations start from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// Runs the parser under test on any bytes. Crashing, hanging or failing a check is a find; errors are not.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// Small valid inputs, made by the project's own writers when they are asked for: none lie in the repository.
std::vector<std::string> FuzzSeeds();
