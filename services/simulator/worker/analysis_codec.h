// Writes what analyses found as messages.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/design/metric.h"
#include "common/fem/linear/linear_solver.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/airflow/airflow.h"
#include "services/simulator/analysis/case_outcome.h"

namespace mortise::simulator {

v1::Metric ToProto(const Metric& metric);

SolverKind SolverKindOf(v1::SolverKind kind);

// `parts` are the names of those that the outcome tells of.
void Fill(const CaseOutcome& outcome, const std::vector<std::string>& parts,
          v1::CaseResult& message);

void Fill(const HeatOutcome& outcome, v1::HeatResult& message);

// `wind` is that of the solution, m/s.
void Fill(const AirflowSolution& solution, const Eigen::Vector3d& wind, v1::AirflowResult& message);

}  // namespace mortise::simulator
