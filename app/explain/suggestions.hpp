#pragma once

#include "app/explain/explanation.hpp"

namespace fascia::app {

/// Parts whose change makes the solve shorter, by however little chance may explain, and changes every probe by less
/// than the limit; by what they gain, largest first. Of --quick: those of which an estimate says so.
std::vector<Part*> worth_suggesting(Explanation& explanation);
/// A part is among them and gains beyond the spread of its times.
bool is_worth(const Explanation& explanation, const Part& part);

/// In the scene's own words. @param solve  measured in turns with the scene as it is; of --quick the estimate
Suggestion suggestion_of(const Explanation& explanation, const Part& part, const Ratio& solve);

/// The suggestions that are left once all are carried out that go together: one for each body and each key.
/// @param parts  of Explanation::suggestions, which are told whether they are among them
/// @return the overrides of all; empty for fewer than two
std::vector<std::string> combined(Explanation& explanation, const std::vector<const Part*>& parts);

/// "the step is 31 % shorter (28 to 33 %)"
std::string gain_text(const Explanation& explanation, const Part& part, const Ratio& solve, bool estimated);
/// "probe `tip` changes by 0.02 %"
std::string change_text(const Explanation& explanation, const ProbeChange& change);

}  // namespace fascia::app
