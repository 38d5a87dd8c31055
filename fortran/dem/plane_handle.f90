!> Blocks of the plane behind a handle, see dem_handle: how they are built, copied for a run, and read after it.
module dem_plane_handle
   use common_handles, only : handle_leave
   use common_kinds, only : wp
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_not_ready, &
      status_out_of_memory, status_wrong_handle
   use dem_bodies, only : body_set, body_set_new, body_turn
   use dem_contacts, only : overlap, measure_overlap
   use dem_handle, only : built_model, count_ties, model_register, model_take
   use dem_loading, only : loading
   use dem_model, only : block_model
   use dem_plane_run, only : block_simulation
   use dem_rigid, only : set_rigid
   use dem_places, only : count_places, places_copy
   use dem_simulation, only : run_record_new
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: built_blocks, blocks_new, blocks_take, blocks_run_take
   public :: set_joints, set_start, closed_contacts

   type, extends(built_model) :: built_blocks
      type(body_set) :: set
      integer(c_int), allocatable :: law_first(:)   !! (bodies + 1) rows of the joint table by lower body
      integer(c_int), allocatable :: law_body(:)    !! the higher body
      integer(c_int), allocatable :: law_number(:)
      type(loading) :: load                         !! without the ground
      real(wp) :: gravity(2) = 0.0_wp               !! [m/s^2]
      real(wp) :: mass_damping = 0.0_wp             !! alpha [1/s]
      real(wp) :: domain(4) = 0.0_wp                !! left, right, bottom, top of the scene [m]
   contains
      procedure :: new_run
   end type built_blocks

contains

   !> Bodies from flat arrays, see body_set_new, behind a handle
   subroutine blocks_new(centroid, mass, inertia, owner, first, vertex, outer, handle, status)
      real(wp), intent(in) :: centroid(:, :)        !! (2, bodies) [m]
      real(wp), intent(in) :: mass(:)               !! (bodies) [kg]; 0 marks a support
      real(wp), intent(in) :: inertia(:)            !! (bodies) [kg m^2]
      integer(c_int), intent(in) :: owner(:)        !! (parts) body of each part, 1-based
      integer(c_int), intent(in) :: first(:)        !! (parts + 1) first vertex of each part, 1-based
      real(wp), intent(in) :: vertex(:, :)          !! (2, vertices) counter-clockwise [m]
      integer(c_int), intent(in) :: outer(:)        !! (vertices) 1: the edge that starts here lies on the outline
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(built_blocks), pointer :: blocks
      class(built_model), pointer :: built
      integer :: failed
      handle = 0
      status = status_out_of_memory
      allocate (blocks, stat=failed)
      if (failed /= 0) return
      call body_set_new(centroid, mass, inertia, owner, first, vertex, outer, blocks%set, status)
      if (status == status_ok) then
         built => blocks
         call model_register(built, handle, status)
      else
         deallocate (blocks)
      end if
   end subroutine blocks_new

   !> The blocks of a handle, for this call alone, until handle_leave; null where the status is not ok
   subroutine blocks_take(handle, blocks, status)
      integer(c_int64_t), intent(in) :: handle
      type(built_blocks), pointer, intent(out) :: blocks
      integer(c_int), intent(out) :: status
      class(built_model), pointer :: built
      blocks => null()
      call model_take(handle, built, status)
      if (status /= status_ok) return
      select type (built)
      type is (built_blocks)
         blocks => built
      class default
         status = status_wrong_handle
         call handle_leave(handle)
      end select
   end subroutine blocks_take

   !> The last run of the blocks of a handle, until handle_leave; null where the status is not ok
   subroutine blocks_run_take(handle, run, status)
      integer(c_int64_t), intent(in) :: handle
      type(block_simulation), pointer, intent(out) :: run
      integer(c_int), intent(out) :: status         !! not_ready where it has not run
      type(built_blocks), pointer :: blocks
      run => null()
      call blocks_take(handle, blocks, status)
      if (status /= status_ok) return
      if (allocated(blocks%run)) then
         select type (last => blocks%run)
         type is (block_simulation)
            run => last
            return
         end select
      end if
      status = status_not_ready
      call handle_leave(handle)
   end subroutine blocks_run_take

   !> Pairs of bodies whose joint has a type of its own; of two entries for one pair the later counts
   subroutine set_joints(built, bodies, law, status)
      type(built_blocks), intent(inout) :: built
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
      built%highest_law = max(0, int(maxval(law)))
      status = status_ok
   end subroutine set_joints

   !> Initial displacement and velocity about the centroids
   subroutine set_start(built, shift, rate)
      type(built_blocks), intent(inout) :: built
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

   !> A run of a copy of what was built, at rest before its first step
   subroutine new_run(built, wanted, status)
      class(built_blocks), intent(inout) :: built
      real(wp), intent(in) :: wanted(:)             !! output times [s]
      integer(c_int), intent(out) :: status
      type(block_simulation), allocatable :: run
      integer :: failed
      status = status_not_ready
      if (.not. allocated(built%law)) return
      status = status_out_of_memory
      allocate (run, stat=failed)
      if (failed /= 0) return
      call start_model(built, run%model, status)
      if (status == status_ok) call run_record_new(size(built%set%item), 3, .false., count_ties(built), &
         size(run%model%contacts%law_body), count_places(built%places), wanted, run%record, status)
      if (status /= status_ok) return
      run%domain = built%domain
      call move_alloc(run, built%run)
   end subroutine new_run

   !> A copy of what was built, at rest before its first step
   subroutine start_model(built, model, status)
      class(built_blocks), intent(in) :: built
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
         model%contacts%law_number(joints), model%contacts%joint_loss(2, joints), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      model%set%item(:) = built%set%item
      model%set%parts(:) = built%set%parts
      model%set%edges(:) = built%set%edges
      model%set%size = built%set%size
      model%law(:) = built%law
      model%contacts%law_first(:) = 1
      model%contacts%joint_loss = 0.0_wp
      if (joints > 0) then
         model%contacts%law_first(:) = built%law_first
         model%contacts%law_body(:) = built%law_body
         model%contacts%law_number(:) = built%law_number
      end if
      if (moves > 0) model%load%move(:) = built%load%move
      call places_copy(built%places, model%places, status)
      if (status /= status_ok) return
      model%gravity = built%gravity
      model%load%moving_base = built%load%moving_base
      model%mass_damping = built%mass_damping
      call set_rigid(model%rigid, model%model_clock, built%rigid, hypot(model%gravity(1), model%gravity(2)), &
         model%set%size, sum(model%set%item%mass))
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
            call measure_overlap(pair, model%set%item(pair%bodies(1)), model%set%item(pair%bodies(2)), now)
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

end module dem_plane_handle
