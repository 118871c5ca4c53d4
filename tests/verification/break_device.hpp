#pragma once

#include <vector>

namespace fascia::test {

/// Makes the present device fail for the rest of this process.
void break_device();

/// Takes all memory of the present device but what its parts are too small for.
std::vector<void*> take_memory();
void give_back(const std::vector<void*>& taken);

}  // namespace fascia::test
