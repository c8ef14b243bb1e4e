// Whether the system gives as many threads as loops will run on.
#pragma once

namespace isoshell {

/// Starts so many threads at once and ends them. Throws: out_of_memory, as OwnThread does.
void try_threads(int count);

}  // namespace isoshell
