!> A model of discrete elements behind a handle: built in steps, run under as many motions as wanted, read after.
!>
!> What was built stays as it is: every run starts from a copy, so runs of one model do not know of each other.
module dem_handle
   use common_handles, only : handle_new, handle_take
   use common_kinds, only : wp
   use common_lists, only : handle_dem
   use common_signal, only : signal
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_not_ready, &
      status_out_of_memory
   use common_threads, only : threads_available
   use dem_bodies, only : body_set, body_turn
   use dem_contacts, only : overlap, measure
   use dem_law, only : joint_law
   use dem_loading, only : loading, support_move
   use dem_model, only : block_model
   use dem_run, only : run_options, run_record, run_record_new, run_begin, run_on
   use dem_state, only : state_load
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_funloc, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   implicit none
   private
   public :: built_model, built_model_register, built_model_destroy, built_model_take
   public :: set_laws, set_joints, set_start, set_moves, run_built, go_on_built, resume_built, closed_contacts

   type :: built_model
      type(body_set) :: set
      type(joint_law), allocatable :: law(:)        !! the first is that of contacts that form later
      integer(c_int), allocatable :: law_first(:)   !! (bodies + 1) rows of the joint table by lower body
      integer(c_int), allocatable :: law_body(:)    !! the higher body
      integer(c_int), allocatable :: law_number(:)
      type(loading) :: load                         !! without the ground
      real(wp) :: mass_damping = 0.0_wp             !! alpha [1/s]
      type(run_options) :: options
      logical :: rigid = .false.                    !! contacts without springs, see dem_moreau
      logical :: quasi_static = .false.
      real(wp) :: rebound = 0.0_wp
      logical :: settled = .false.                  !! the settings were given
      type(block_model), allocatable :: model                !! as the last run left it
      type(run_record), allocatable :: record       !! of the last run
   end type built_model

contains

   !> Hand a model over to the registry
   subroutine built_model_register(built, handle, status)
      type(built_model), pointer, intent(inout) :: built   !! null after a failure
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      call handle_new(handle_dem, c_loc(built), c_funloc(built_model_destroy), handle, status)
      if (status /= status_ok) deallocate (built)
   end subroutine built_model_register

   !> Called by the registry
   subroutine built_model_destroy(object) bind(c, name='extrados_dem_destroy')
      type(c_ptr), value, intent(in) :: object
      type(built_model), pointer :: built
      call c_f_pointer(object, built)
      deallocate (built)
   end subroutine built_model_destroy

   !> The model of a handle, for this call alone, until handle_leave; null where the status is not ok
   subroutine built_model_take(handle, built, status)
      integer(c_int64_t), intent(in) :: handle
      type(built_model), pointer, intent(out) :: built
      integer(c_int), intent(out) :: status
      type(c_ptr) :: object
      built => null()
      object = c_null_ptr
      call handle_take(handle, handle_dem, .true., object, status)
      if (status == status_ok) call c_f_pointer(object, built)
   end subroutine built_model_take

   !> Types of joints
   subroutine set_laws(built, law, status)
      type(built_model), intent(inout) :: built
      type(joint_law), intent(in) :: law(:)
      integer(c_int), intent(out) :: status
      type(joint_law), allocatable :: copy(:)
      integer :: failed
      status = status_invalid_argument
      if (size(law) < 1) return
      if (.not. all(law%normal_stiffness > 0.0_wp .and. law%shear_stiffness > 0.0_wp)) return
      if (.not. all(min(law%friction, law%cohesion, law%tension, law%damping) >= 0.0_wp)) return
      if (allocated(built%law_number)) then
         if (any(built%law_number > size(law))) return
      end if
      status = status_out_of_memory
      allocate (copy(size(law)), stat=failed)
      if (failed /= 0) return
      copy(:) = law
      call move_alloc(copy, built%law)
      status = status_ok
   end subroutine set_laws

   !> Pairs of bodies whose joint has a type of its own; of two entries for one pair the later counts
   subroutine set_joints(built, bodies, law, status)
      type(built_model), intent(inout) :: built
      integer(c_int), intent(in) :: bodies(:, :)    !! (2, joints), 1-based
      integer(c_int), intent(in) :: law(:)          !! (joints), 1-based
      integer(c_int), intent(out) :: status
      integer(c_int), allocatable :: first(:), higher(:), number(:)
      integer :: k, b, failed
      status = status_not_ready
      if (.not. allocated(built%law)) return
      status = status_bad_index
      if (any(bodies < 1) .or. any(bodies > size(built%set%item)) .or. any(bodies(1, :) == bodies(2, :))) return
      if (any(law < 1) .or. any(law > size(built%law))) return
      status = status_out_of_memory
      allocate (first(size(built%set%item) + 1), higher(size(law)), number(size(law)), stat=failed)
      if (failed /= 0) return
      first = 0
      do k = 1, size(law)
         b = minval(bodies(:, k)) + 1
         first(b) = first(b) + 1_c_int
      end do
      first(1) = 1
      do b = 2, size(first)
         first(b) = first(b) + first(b - 1)
      end do
      do k = 1, size(law)
         b = minval(bodies(:, k))
         higher(first(b)) = maxval(bodies(:, k))
         number(first(b)) = law(k)
         first(b) = first(b) + 1_c_int
      end do
      do b = size(first), 2, -1   ! each row was moved to its end
         first(b) = first(b - 1)
      end do
      first(1) = 1
      call move_alloc(first, built%law_first)
      call move_alloc(higher, built%law_body)
      call move_alloc(number, built%law_number)
      status = status_ok
   end subroutine set_joints

   !> Initial displacement and velocity about the centroids
   subroutine set_start(built, shift, rate)
      type(built_model), intent(inout) :: built
      real(wp), intent(in) :: shift(:, :)           !! (3, bodies) x, y [m], rotation [rad]
      real(wp), intent(in) :: rate(:, :)            !! (3, bodies) [m/s, rad/s]
      built%set%item%x = built%set%item%x + shift(1, :)
      built%set%item%y = built%set%item%y + shift(2, :)
      built%set%item%angle = shift(3, :)
      call body_turn(built%set%item)
      built%set%item%vx = rate(1, :)
      built%set%item%vy = rate(2, :)
      built%set%item%spin = rate(3, :)
   end subroutine set_start

   !> Supports that give way
   subroutine set_moves(built, move, status)
      type(built_model), intent(inout) :: built
      type(support_move), intent(in) :: move(:)
      integer(c_int), intent(out) :: status
      type(support_move), allocatable :: copy(:)
      integer :: k, failed
      do k = 1, size(move)
         status = status_bad_index
         if (move(k)%body < 1 .or. move(k)%body > size(built%set%item)) return
         if (.not. built%set%item(move(k)%body)%fixed) return
         status = status_invalid_argument
         if (.not. move(k)%duration > 0.0_wp) return
      end do
      status = status_out_of_memory
      allocate (copy(size(move)), stat=failed)
      if (failed /= 0) return
      copy(:) = move
      call move_alloc(copy, built%load%move)
      status = status_ok
   end subroutine set_moves

   !> Run from the state that was built, to its end or until it pauses; a cancelled run leaves what it has
   subroutine run_built(built, ground, wanted, steps, status)
      type(built_model), intent(inout) :: built
      type(signal), intent(in) :: ground
      real(wp), intent(in) :: wanted(:)             !! output times [s]
      integer, intent(in) :: steps                  !! after which it pauses; 0: it does not
      integer(c_int), intent(out) :: status
      type(run_options) :: options
      type(signal) :: silence
      call new_run(built, wanted, status)
      if (status /= status_ok) return
      built%model%load%ground = ground
      options = built%options
      options%threads = threads_available(options%threads)
      call run_begin(built%model, options, built%record, status)
      built%model%load%ground = silence   ! it pointed into the caller's set
      if (status == status_ok .and. built%record%paused) call go_on_built(built, ground, steps, status)
   end subroutine run_built

   !> Go on with a run that has paused, under the same motion
   subroutine go_on_built(built, ground, steps, status)
      type(built_model), intent(inout) :: built
      type(signal), intent(in) :: ground
      integer, intent(in) :: steps                  !! after which it pauses again; 0: it does not
      integer(c_int), intent(out) :: status
      type(run_options) :: options
      type(signal) :: silence
      status = status_not_ready
      if (.not. allocated(built%record)) return
      if (.not. built%record%paused) return
      built%model%load%ground = ground
      options = built%options
      options%threads = threads_available(options%threads)
      call run_on(built%model, options, steps, built%record, status)
      built%model%load%ground = silence
   end subroutine go_on_built

   !> Take back the state of a run that had paused; see dem_state
   subroutine resume_built(built, wanted, word, status)
      type(built_model), intent(inout) :: built
      real(wp), intent(in) :: wanted(:)             !! output times [s]
      integer(c_int64_t), intent(in) :: word(:)
      integer(c_int), intent(out) :: status
      call new_run(built, wanted, status)
      if (status /= status_ok) return
      call state_load(word, built%model, built%record, status)
      if (status /= status_ok) deallocate (built%model, built%record)
   end subroutine resume_built

   !> A model and a record that have not run yet
   subroutine new_run(built, wanted, status)
      type(built_model), intent(inout) :: built
      real(wp), intent(in) :: wanted(:)             !! output times [s]
      integer(c_int), intent(out) :: status
      integer :: failed
      status = status_not_ready
      if (.not. (allocated(built%law) .and. built%settled)) return
      if (allocated(built%model)) deallocate (built%model)
      if (allocated(built%record)) deallocate (built%record)
      status = status_out_of_memory
      allocate (built%model, built%record, stat=failed)
      if (failed /= 0) return
      call start_model(built, built%model, status)
      if (status == status_ok) call run_record_new(size(built%set%item), wanted, built%record, status)
      if (status /= status_ok) deallocate (built%model, built%record)
   end subroutine new_run

   !> A copy of what was built, at rest before its first step
   subroutine start_model(built, model, status)
      type(built_model), intent(in) :: built
      type(block_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: bodies, joints, moves, failed
      bodies = size(built%set%item)
      joints = 0
      if (allocated(built%law_number)) joints = size(built%law_number)
      moves = 0
      if (allocated(built%load%move)) moves = size(built%load%move)
      allocate (model%set%item(bodies), model%set%parts(size(built%set%parts)), &
         model%set%edges(size(built%set%edges)), model%law(size(built%law)), model%load%move(moves), &
         model%contacts%law_first(bodies + 1), model%contacts%law_body(joints), &
         model%contacts%law_number(joints), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      model%set%item(:) = built%set%item
      model%set%parts(:) = built%set%parts
      model%set%edges(:) = built%set%edges
      model%set%size = built%set%size
      model%law(:) = built%law
      model%contacts%law_first(:) = 1
      if (joints > 0) then
         model%contacts%law_first(:) = built%law_first
         model%contacts%law_body(:) = built%law_body
         model%contacts%law_number(:) = built%law_number
      end if
      if (moves > 0) model%load%move(:) = built%load%move
      model%load%gravity = built%load%gravity
      model%load%moving_base = built%load%moving_base
      model%mass_damping = built%mass_damping
      model%rigid%used = built%rigid
      model%rigid%quasi_static = built%quasi_static
      model%rigid%rebound = built%rebound
   end subroutine start_model

   !> Contact points that are closed at the end of the last run; counts them, writes as many as there is room for
   subroutine closed_contacts(model, bodies, values, found)
      type(block_model), intent(in) :: model
      integer(c_int), intent(out) :: bodies(:, :)   !! (2, room)
      !> (6, room) x, y [m], force on the second body x, y, normal, shear [N]
      real(wp), intent(out) :: values(:, :)
      integer, intent(out) :: found
      type(overlap) :: now
      integer :: k, i
      real(wp) :: normal, shear
      bodies = 0
      values = 0.0_wp
      found = 0
      do k = 1, model%contacts%pairs
         associate (pair => model%contacts%pair(k))
            call measure(pair, model%set%item(pair%bodies(1)), model%set%item(pair%bodies(2)), now)
            do i = 1, 2
               if (.not. pair%point(i)%closed) cycle
               found = found + 1
               if (found > size(bodies, 2)) cycle
               normal = pair%point(i)%spring_n + pair%point(i)%dash_n
               shear = pair%point(i)%spring_s + pair%point(i)%dash_s
               bodies(:, found) = int(pair%bodies, c_int)
               values(:, found) = [now%x(i), now%y(i), normal * now%ty(i) + shear * now%tx(i), &
                  shear * now%ty(i) - normal * now%tx(i), normal, shear]
            end do
         end associate
      end do
   end subroutine closed_contacts

end module dem_handle
