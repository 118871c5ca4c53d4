#pragma once

#include "app/study/evaluation.hpp"

namespace fascia::app {

/// Runs that share all axes but one with the run at `like`, of decreasing size; none where that axis varies neither the
/// number of unknowns nor a time step.
std::optional<SizeSeries> series_of(const StudyResult& result, std::size_t axis, const std::vector<std::size_t>& like);

/// The best value that a study has of its own: of the runs that are the finest of their kind, each extrapolated by
/// Richardson's method over every axis that varies a size, the one with the least uncertainty; where none shows an
/// order, the run with the most unknowns and steps. A curve is taken as it is.
ReferenceValue finest_value(const StudyResult& result, const Question& question);

/// The best field that a study has of its own, likewise. It is not extrapolated: how far it is from the limit is, by
/// the distances of coarser runs from it, its uncertainty. @param directory  of the study
ReferenceValue finest_field(StudyResult& result, const Question& question, const std::filesystem::path& directory);

}  // namespace fascia::app
