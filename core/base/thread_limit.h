/// Whether as many threads as are asked for can be had. OpenMP does not say: some of its libraries give fewer without a
/// word, and others end the program.
#pragma once

namespace raypool {

/// Refuses (InputError, which names `option`) none, more threads than OpenMP would give (OMP_THREAD_LIMIT), more than
/// 4096, and more than the system lets this process create now with stacks as large as OpenMP's (OMP_STACKSIZE). The
/// last is found out by creating them, for a moment: some 20 microseconds each. Call it before the first parallel
/// region, whose threads stay and would be counted twice.
void check_thread_count(int count, const char* option);

}  // namespace raypool
