!> The whole state of a run in space that has paused, as words that can be kept and taken back; see dem_state.
module dem3_state
   use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
   use dem_state, only : tape, saving, loading, per_word
   use dem3_bodies, only : body
   use dem3_law, only : contact_point
   use dem3_model, only : colour, solid_model
   use dem3_run, only : run_record
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_int, c_int64_t, c_loc
   implicit none
   private
   public :: state_words, state_save, state_load

   integer, parameter :: entries = 8        !! of the head

contains

   !> Words that the state takes
   function state_words(model, record) result(words)
      type(solid_model), intent(inout), target :: model
      type(run_record), intent(inout), target :: record
      integer(c_int64_t) :: words
      type(tape) :: measure
      call walk(measure, model, record)
      words = entries + (measure%at + per_word - 1) / per_word
   end function state_words

   !> Write the state; state_words tells how many words there must be
   subroutine state_save(model, record, word, status)
      type(solid_model), intent(inout), target :: model
      type(run_record), intent(inout), target :: record
      integer(c_int64_t), intent(out), target :: word(:)
      integer(c_int), intent(out) :: status
      type(tape) :: out
      word = 0
      status = status_invalid_argument
      if (size(word, kind=c_int64_t) /= state_words(model, record)) return
      word(1:entries) = head(model, record, size(word, kind=c_int64_t))
      out%mode = saving
      call c_f_pointer(c_loc(word(entries + 1)), out%bytes, [per_word * (size(word) - entries)])
      call walk(out, model, record)
      status = merge(status_invalid_argument, status_ok, out%short)
   end subroutine state_save

   !> Take a state back into a model at its start and a new record; invalid where it is of another model or build
   subroutine state_load(word, model, record, status)
      integer(c_int64_t), intent(in), target :: word(:)
      type(solid_model), intent(inout), target :: model
      type(run_record), intent(inout), target :: record
      integer(c_int), intent(out) :: status
      type(tape) :: in
      integer :: failed

      status = status_invalid_argument
      if (size(word) <= entries) return
      if (word(6) < 0 .or. word(6) > size(word) .or. word(7) < 0 .or. word(7) > size(record%wanted)) return
      if (allocated(model%pair)) deallocate (model%pair)
      allocate (model%pair(word(6)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      model%pairs = int(word(6))
      record%points = int(word(7))
      status = status_invalid_argument
      if (any(word(1:entries) /= head(model, record, size(word, kind=c_int64_t)))) return
      in%mode = loading
      call c_f_pointer(c_loc(word(entries + 1)), in%bytes, [per_word * (size(word) - entries)])
      call walk(in, model, record)
      if (in%short) return
      if (entries + (in%at + per_word - 1) / per_word /= size(word)) return
      call colour(model, status)
   end subroutine state_load

   !> What must be the same where a state is taken back, and the lengths that vary
   function head(model, record, words) result(told)
      type(solid_model), intent(in) :: model
      type(run_record), intent(in) :: record
      integer(c_int64_t), intent(in) :: words
      integer(c_int64_t) :: told(entries)
      type(body) :: one
      type(contact_point) :: point
      told = [words, storage_size(one) + 100000_c_int64_t * storage_size(point), size(model%set%item, kind=c_int64_t), &
         size(model%set%parts, kind=c_int64_t), size(record%wanted, kind=c_int64_t), int(model%pairs, c_int64_t), &
         int(record%points, c_int64_t), 3_c_int64_t]
   end function head

   !> Pass everything that changes while a model runs, always in this order
   subroutine walk(on, model, record)
      type(tape), intent(inout) :: on
      type(solid_model), intent(inout), target :: model
      type(run_record), intent(inout), target :: record
      integer :: n, k, failed
      n = record%points
      call on%pass(model%set%item, storage_size(model%set%item))
      call on%pass(model%t, storage_size(model%t))
      call on%pass(model%step, storage_size(model%step))
      call on%pass(model%drift, storage_size(model%drift))
      call on%pass(model%kick, storage_size(model%kick))
      call on%pass(model%pull, storage_size(model%pull))
      call on%pass(model%pull_before, storage_size(model%pull_before))
      call on%pass(model%skin, storage_size(model%skin))
      call on%pass(model%reach, storage_size(model%reach))
      call on%pass(model%margin, storage_size(model%margin))
      call on%pass(model%far, storage_size(model%far))
      call on%pass(model%wander, storage_size(model%wander))
      call on%pass(model%lost, storage_size(model%lost))
      call on%pass(model%support_work, storage_size(model%support_work))
      call on%pass(model%segment, storage_size(model%segment))
      call on%pass(model%steps, storage_size(model%steps))
      call on%pass(model%shaking, storage_size(model%shaking))
      do k = 1, model%pairs
         associate (pair => model%pair(k))
            call on%pass(pair%part, storage_size(pair%part))
            call on%pass(pair%law, storage_size(pair%law))
            call on%pass(pair%points, storage_size(pair%points))
            call on%pass(pair%reference, storage_size(pair%reference))
            call on%pass(pair%marks, storage_size(pair%marks))
            call on%pass(pair%place, storage_size(pair%place))
            call on%pass(pair%turn, storage_size(pair%turn))
            call on%pass(pair%friction_loss, storage_size(pair%friction_loss))
            call on%pass(pair%damping_loss, storage_size(pair%damping_loss))
            call on%pass(pair%support_work, storage_size(pair%support_work))
            if (on%mode == loading) then
               if (on%short .or. pair%points < 0 .or. pair%points > size(on%bytes)) then
                  on%short = .true.
                  return
               end if
               allocate (pair%point(pair%points), stat=failed)
               on%short = failed /= 0
               if (on%short) return
            end if
            if (allocated(pair%point)) call on%pass(pair%point, storage_size(pair%point))
         end associate
      end do
      call on%pass(record%wanted, storage_size(record%wanted))
      call on%pass(record%time(1:n), storage_size(record%time))
      call on%pass(record%place(:, :, 1:n), storage_size(record%place))
      call on%pass(record%turn(:, :, :, 1:n), storage_size(record%turn))
      call on%pass(record%rate(:, :, 1:n), storage_size(record%rate))
      call on%pass(record%energy(:, 1:n), storage_size(record%energy))
      call on%pass(record%blamed, storage_size(record%blamed))
      call on%pass(record%settling, storage_size(record%settling))
      call on%pass(record%searches, storage_size(record%searches))
      call on%pass(record%most_pairs, storage_size(record%most_pairs))
      call on%pass(record%least_step, storage_size(record%least_step))
      call on%pass(record%critical, storage_size(record%critical))
      call on%pass(record%stop_time, storage_size(record%stop_time))
      call on%pass(record%residual, storage_size(record%residual))
      call on%pass(record%start, storage_size(record%start))
      call on%pass(record%round, storage_size(record%round))
      call on%pass(record%calm_looks, storage_size(record%calm_looks))
      call on%pass(record%paused, storage_size(record%paused))
   end subroutine walk

end module dem3_state
