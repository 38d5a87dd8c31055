!> The whole state of a run that has paused, as words that can be kept and taken back: a run that goes on from them ends
!> with the same bits.
!>
!> They are bytes of memory, for this build alone; whoever keeps them must see that they come back undamaged.
module dem_state
   use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
   use dem_bodies, only : body
   use dem_contacts, only : contact_pair
   use dem_model, only : block_model
   use dem_run, only : run_record
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_int, c_int8_t, c_int64_t, c_loc
   implicit none
   private
   public :: state_words, state_save, state_load
   public :: tape, measuring, saving, loading, per_word

   integer, parameter :: entries = 10       !! of the head
   integer, parameter :: per_word = 8       !! bytes
   integer, parameter :: measuring = 0, saving = 1, loading = 2

   !> Where the walk through a state stands
   type :: tape
      integer(c_int8_t), pointer :: bytes(:) => null()
      integer(c_int64_t) :: at = 0
      integer :: mode = measuring
      logical :: short = .false.            !! there were fewer bytes than the state has
   contains
      procedure :: pass
   end type tape

contains

   !> Words that the state takes
   function state_words(model, record) result(words)
      type(block_model), intent(inout), target :: model
      type(run_record), intent(inout), target :: record
      integer(c_int64_t) :: words
      type(tape) :: measure
      call walk(measure, model, record)
      words = entries + (measure%at + per_word - 1) / per_word
   end function state_words

   !> Write the state; state_words tells how many words there must be
   subroutine state_save(model, record, word, status)
      type(block_model), intent(inout), target :: model
      type(run_record), intent(inout), target :: record
      integer(c_int64_t), intent(out), target :: word(:)
      integer(c_int), intent(out) :: status
      type(tape) :: out
      word = 0
      status = status_invalid_argument
      if (size(word, kind=c_int64_t) /= state_words(model, record)) return
      word(1:entries) = head(model, record)
      out%mode = saving
      call c_f_pointer(c_loc(word(entries + 1)), out%bytes, [per_word * (size(word) - entries)])
      call walk(out, model, record)
      status = merge(status_invalid_argument, status_ok, out%short)
   end subroutine state_save

   !> Take a state back into a model at its start and a new record; invalid where it is of another model or build
   subroutine state_load(word, model, record, status)
      integer(c_int64_t), intent(in), target :: word(:)
      type(block_model), intent(inout), target :: model
      type(run_record), intent(inout), target :: record
      integer(c_int), intent(out) :: status
      type(tape) :: in
      integer :: parts, failed

      status = status_invalid_argument
      if (size(word) <= entries) return
      if (word(1) /= size(word)) return
      if (any(word(6:entries) < 0) .or. any(word(6:entries) > size(word, kind=c_int64_t))) return
      parts = size(model%set%parts)
      status = status_out_of_memory
      associate (contacts => model%contacts)
         allocate (contacts%pair(word(6)), contacts%spare(word(7)), contacts%row(parts + 1), &
            contacts%sequence(word(8)), contacts%sweep(parts), contacts%box(4, parts), &
            contacts%used(size(model%set%item)), contacts%colour_first(word(9)), stat=failed)
      end associate
      if (failed /= 0) return
      status = status_invalid_argument
      if (word(10) > size(record%wanted)) return
      record%points = int(word(10))
      if (any(word(1:entries) /= head(model, record, word(1)))) return
      if (size(word, kind=c_int64_t) /= state_words(model, record)) return
      in%mode = loading
      call c_f_pointer(c_loc(word(entries + 1)), in%bytes, [per_word * (size(word) - entries)])
      call walk(in, model, record)
      if (.not. in%short) status = status_ok
   end subroutine state_load

   !> What must be the same where a state is taken back, and the lengths that vary
   function head(model, record, words) result(told)
      type(block_model), intent(inout), target :: model
      type(run_record), intent(inout), target :: record
      integer(c_int64_t), intent(in), optional :: words
      integer(c_int64_t) :: told(entries)
      type(body) :: one
      type(contact_pair) :: pair
      told(1) = 0
      if (present(words)) then
         told(1) = words
      else
         told(1) = state_words(model, record)
      end if
      told(2) = storage_size(one) + 100000_c_int64_t * storage_size(pair)
      told(3) = size(model%set%item)
      told(4) = size(model%set%parts)
      told(5) = size(record%wanted)
      told(6) = size(model%contacts%pair)
      told(7) = size(model%contacts%spare)
      told(8) = size(model%contacts%sequence)
      told(9) = size(model%contacts%colour_first)
      told(10) = record%points
   end function head

   !> Pass everything that changes while a model runs, always in this order
   subroutine walk(on, model, record)
      type(tape), intent(inout) :: on
      type(block_model), intent(inout), target :: model
      type(run_record), intent(inout), target :: record
      integer :: n
      n = record%points
      call on%pass(model%set%item, storage_size(model%set%item))
      call on%pass(model%t, storage_size(model%t))
      call on%pass(model%step, storage_size(model%step))
      call on%pass(model%drift, storage_size(model%drift))
      call on%pass(model%kick, storage_size(model%kick))
      call on%pass(model%pull, storage_size(model%pull))
      call on%pass(model%pull_before, storage_size(model%pull_before))
      call on%pass(model%base, storage_size(model%base))
      call on%pass(model%base_place, storage_size(model%base_place))
      call on%pass(model%segment, storage_size(model%segment))
      call on%pass(model%steps, storage_size(model%steps))
      call on%pass(model%shaking, storage_size(model%shaking))
      call on%pass(model%stale, storage_size(model%stale))
      call on%pass(model%rigid%waits, storage_size(model%rigid%waits))
      call on%pass(model%rigid%steps, storage_size(model%rigid%steps))
      call on%pass(model%rigid%factors, storage_size(model%rigid%factors))
      call on%pass(model%rigid%most_rounds, storage_size(model%rigid%most_rounds))
      call on%pass(model%rigid%open_steps, storage_size(model%rigid%open_steps))
      call on%pass(model%rigid%residual, storage_size(model%rigid%residual))
      associate (contacts => model%contacts)
         call on%pass(contacts%pairs, storage_size(contacts%pairs))
         call on%pass(contacts%pair, storage_size(contacts%pair))
         call on%pass(contacts%row, storage_size(contacts%row))
         call on%pass(contacts%sequence, storage_size(contacts%sequence))
         call on%pass(contacts%colours, storage_size(contacts%colours))
         call on%pass(contacts%alone, storage_size(contacts%alone))
         call on%pass(contacts%colour_first, storage_size(contacts%colour_first))
         call on%pass(contacts%sweep, storage_size(contacts%sweep))
         call on%pass(contacts%box, storage_size(contacts%box))
         call on%pass(contacts%used, storage_size(contacts%used))
         call on%pass(contacts%skin, storage_size(contacts%skin))
         call on%pass(contacts%friction_loss, storage_size(contacts%friction_loss))
         call on%pass(contacts%damping_loss, storage_size(contacts%damping_loss))
         call on%pass(contacts%support_work, storage_size(contacts%support_work))
      end associate
      call on%pass(record%wanted, storage_size(record%wanted))
      call on%pass(record%time(1:n), storage_size(record%time))
      call on%pass(record%place(:, :, 1:n), storage_size(record%place))
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
      call on%pass(record%taken, storage_size(record%taken))
      call on%pass(record%calm_looks, storage_size(record%calm_looks))
      call on%pass(record%paused, storage_size(record%paused))
   end subroutine walk

   !> Count, write or read the bytes of one part
   subroutine pass(on, part, bits)
      class(tape), intent(inout) :: on
      type(*), intent(inout), target, contiguous :: part(..)
      integer, intent(in) :: bits           !! of one element
      integer(c_int8_t), pointer :: bytes(:)
      integer(c_int64_t) :: count
      count = size(part, kind=c_int64_t) * (bits / per_word)
      if (on%mode /= measuring .and. count > 0) then
         on%short = on%short .or. on%at + count > size(on%bytes, kind=c_int64_t)
         if (on%short) return
         call c_f_pointer(c_loc(part), bytes, [count])
         if (on%mode == saving) then
            on%bytes(on%at + 1:on%at + count) = bytes
         else
            bytes = on%bytes(on%at + 1:on%at + count)
         end if
      end if
      on%at = on%at + count
   end subroutine pass

end module dem_state
