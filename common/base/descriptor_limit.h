// How many files and sockets a process may have open at a time, and how many connections that
// leaves.
#pragma once

namespace mortise {

// Returns the soft limit of open descriptors.
int DescriptorLimit();

// Raises the soft limit to the hard one, at most to 65536, since nothing here needs more and some
// systems allow a thousand million; returns what it is then. At the start of a process.
int RaiseDescriptorLimit();

// Returns how many connections of clients all servers of a process may hold together: what the
// limit leaves after a reserve for the store, channels to other processes, threads' queues and
// logs. 256 are reserved, and half of a limit below 512.
int ConnectionsWithin(int descriptor_limit);

// Whether so many descriptors are open that the next must be for the process's own needs. Systems
// give the lowest free number, so the number of a new descriptor tells how many are open at least.
bool IsAmongTheLast(int descriptor);

}  // namespace mortise
