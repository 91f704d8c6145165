// Every command of `mortise`, as what adds it to the command line.
#pragma once

#include "cli/client/session.h"

namespace CLI {
class App;
}

namespace mortise::cli {

// Each adds its subcommands to `app`; `session` outlives the parsing.
void AddHouseCommands(CLI::App& app, Session& session);     // up, down, status, keys
void AddCallCommand(CLI::App& app, Session& session);       // call, health
void AddAssemblyCommands(CLI::App& app, Session& session);  // assembly import|list|show|delete …
void AddCatalogCommands(CLI::App& app, Session& session);   // catalog import|list|show|delete …
void AddCatalogPlaceCommand(CLI::App& catalog, Session& session);  // of those
void AddAnalyzeCommand(CLI::App& app, Session& session);           // analyze
void AddParetoCommands(CLI::App& app, Session& session);  // pareto run|show|describe|pick|benchmark
void AddParetoBenchmarkCommand(CLI::App& pareto, Session& session);  // of those
void AddParetoDescribeCommand(CLI::App& pareto, Session& session);   // of those
void AddParetoExploreCommands(CLI::App& pareto, Session& session);   // of those
void AddMapCommands(CLI::App& app, Session& session);         // map build|evaluate|optimize|…
void AddMapBuildCommand(CLI::App& map, Session& session);     // of those
void AddMapEvaluateCommand(CLI::App& map, Session& session);  // of those
void AddMapExploreCommand(CLI::App& map, Session& session);   // of those
void AddMapOptimizeCommand(CLI::App& map, Session& session);  // of those
void AddMapShapeCommand(CLI::App& map, Session& session);     // of those
void AddComposeHistoryCommand(CLI::App& compose, Session& session);  // of those
void AddComposeCommands(CLI::App& app, Session& session);            // compose new|add|snap …
void AddComposeRunCommand(CLI::App& compose, Session& session);      // of those
void AddPlanCommand(CLI::App& app, Session& session);                // plan
void AddFabCommands(CLI::App& app, Session& session);   // fab release|list|watch|show|hold|resume
void AddListCommand(CLI::App& app, Session& session);   // list
void AddLabelCommand(CLI::App& app, Session& session);  // label
void AddFindCommand(CLI::App& app, Session& session);   // find
void AddRetrievalCommands(CLI::App& app, Session& session);  // search, index build|status
void AddOperationCommands(CLI::App& app, Session& session);  // operations list|show|watch|cancel
void AddEventsCommand(CLI::App& app, Session& session);      // events
void AddDemoCommand(CLI::App& app, Session& session);        // demo
void AddCompletionCommand(CLI::App& app, Session& session);  // completion

}  // namespace mortise::cli
