!> The whole state of a run that has paused, as words that can be kept and taken back: a run that goes on from them ends
!> with the same bits.
!>
!> They are bytes of memory, for this build alone; whoever keeps them must see that they come back undamaged.
module dem_state
   use common_status, only : status_ok, status_invalid_argument
   use dem_jointed, only : jointed_model
   use dem_rigid, only : walk_effort
   use dem_simulation, only : model_sizes, simulation
   use dem_tape, only : tape, loading, saving, per_word
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_int, c_int64_t, c_loc
   implicit none
   private
   public :: state_words, state_save, state_load

   !> Entries of the head: words, output times, points, and the sizes of the model
   integer, parameter :: entries = 3 + model_sizes

contains

   !> Words that the state takes
   function state_words(run) result(words)
      class(simulation), intent(inout), target :: run
      integer(c_int64_t) :: words
      type(tape) :: measure
      integer(c_int) :: status
      call walk(measure, run, status)
      words = entries + (measure%at + per_word - 1) / per_word
   end function state_words

   !> Write the state; state_words gives the number of words
   subroutine state_save(run, word, status)
      class(simulation), intent(inout), target :: run
      integer(c_int64_t), intent(out), target :: word(:)
      integer(c_int), intent(out) :: status
      type(tape) :: out
      word = 0
      status = status_invalid_argument
      if (size(word, kind=c_int64_t) /= state_words(run)) return
      word(1:entries) = head(run, size(word, kind=c_int64_t))
      out%mode = saving
      call open_tape(out, word)
      call walk(out, run, status)
      if (out%short) status = status_invalid_argument
   end subroutine state_save

   !> Take a state back into a run that has not begun; invalid where it is of another model or build
   subroutine state_load(word, run, status)
      integer(c_int64_t), intent(in), target :: word(:)
      class(simulation), intent(inout), target :: run
      integer(c_int), intent(out) :: status
      type(tape) :: in

      status = status_invalid_argument
      if (size(word) <= entries) return
      if (word(3) < 0 .or. word(3) > size(run%record%wanted)) return
      run%record%points = int(word(3))
      call run%allocate_state(word(4:entries), size(word, kind=c_int64_t), status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if (any(word(1:entries) /= head(run, size(word, kind=c_int64_t)))) return
      in%mode = loading
      call open_tape(in, word)
      call walk(in, run, status)
      if (status /= status_ok) return
      if (in%short .or. entries + (in%at + per_word - 1) / per_word /= size(word)) status = status_invalid_argument
   end subroutine state_load

   !> The bytes behind the head
   subroutine open_tape(on, word)
      type(tape), intent(inout) :: on
      integer(c_int64_t), intent(in), target :: word(:)
      call c_f_pointer(c_loc(word(entries + 1)), on%bytes, [per_word * (size(word) - entries)])
   end subroutine open_tape

   !> What must be the same where a state is taken back, and the lengths that vary
   function head(run, words) result(told)
      class(simulation), intent(in) :: run
      integer(c_int64_t), intent(in) :: words
      integer(c_int64_t) :: told(entries)
      told(1:3) = [words, size(run%record%wanted, kind=c_int64_t), int(run%record%points, c_int64_t)]
      told(4:entries) = run%list_sizes()
   end function head

   !> Pass everything that changes while a model runs, always in this order
   subroutine walk(on, run, status)
      type(tape), intent(inout) :: on
      class(simulation), intent(inout), target :: run
      integer(c_int), intent(out) :: status
      class(jointed_model), pointer :: model
      integer :: n
      call run%walk_state(on, status)
      if (status /= status_ok) return
      model => run%get_model()
      call on%pass(model%t, storage_size(model%t))
      call on%pass(model%step, storage_size(model%step))
      call on%pass(model%drift, storage_size(model%drift))
      call on%pass(model%kick, storage_size(model%kick))
      call on%pass(model%segment, storage_size(model%segment))
      call on%pass(model%segment_across, storage_size(model%segment_across))
      call on%pass(model%steps, storage_size(model%steps))
      call on%pass(model%waits, storage_size(model%waits))
      call on%pass(model%shaking, storage_size(model%shaking))
      call on%pass(model%stale, storage_size(model%stale))
      call walk_effort(model%rigid, on)
      call on%pass(model%ties%item, storage_size(model%ties%item))
      call on%pass(model%ties%anchor, storage_size(model%ties%anchor))
      call on%pass(model%ties%support_work, storage_size(model%ties%support_work))
      associate (record => run%record)
         n = record%points
         call on%pass(record%wanted, storage_size(record%wanted))
         call on%pass(record%time(1:n), storage_size(record%time))
         call on%pass(record%place(:, :, 1:n), storage_size(record%place))
         call on%pass(record%turn(:, :, :, 1:n), storage_size(record%turn))
         call on%pass(record%rate(:, :, 1:n), storage_size(record%rate))
         call on%pass(record%energy(:, 1:n), storage_size(record%energy))
         call on%pass(record%tension(:, 1:n), storage_size(record%tension))
         call on%pass(record%joint(:, :, 1:n), storage_size(record%joint))
         call on%pass(record%press(:, :, 1:n), storage_size(record%press))
         call on%pass(record%blamed, storage_size(record%blamed))
         call on%pass(record%settling, storage_size(record%settling))
         call on%pass(record%searches, storage_size(record%searches))
         call on%pass(record%pairs, storage_size(record%pairs))
         call on%pass(record%most_pairs, storage_size(record%most_pairs))
         call on%pass(record%least_step, storage_size(record%least_step))
         call on%pass(record%critical, storage_size(record%critical))
         call on%pass(record%stop_time, storage_size(record%stop_time))
         call on%pass(record%residual, storage_size(record%residual))
         call on%pass(record%start, storage_size(record%start))
         call on%pass(record%round, storage_size(record%round))
         call on%pass(record%taken, storage_size(record%taken))
         call on%pass(record%damping, storage_size(record%damping))
         call on%pass(record%calm_looks, storage_size(record%calm_looks))
         call on%pass(record%begun, storage_size(record%begun))
         call on%pass(record%paused, storage_size(record%paused))
      end associate
   end subroutine walk

end module dem_state
