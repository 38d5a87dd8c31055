!> Blocks in space behind a handle, see dem_handle: how they are built, and how a run copies them.
module dem3_handle
   use common_handles, only : handle_leave
   use common_kinds, only : wp
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_not_ready, &
      status_out_of_memory, status_wrong_handle
   use dem_handle, only : built_model, count_ties, model_register, model_take
   use dem_loading, only : accept_moves, loading
   use dem_rigid, only : set_rigid
   use dem_places, only : count_places, places_copy
   use dem_simulation, only : run_record_new
   use dem3_bodies, only : body_set, body_set_new, copy_bodies
   use dem3_dowels, only : dowel
   use dem3_run, only : solid_simulation
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: built_solids, solids_new, solids_take, solids_run_take, set_joints, set_moves, set_dowels, set_surroundings

   type, extends(built_model) :: built_solids
      type(body_set) :: set
      integer, allocatable :: law_of(:, :)            !! (3, joints): bodies, the lower first, and law
      type(loading) :: load                           !! without the ground; supports move along x, y, z
      type(dowel), allocatable :: dowels(:)           !! not allocated: none
      real(wp), allocatable :: rate(:, :)             !! (6, bodies) velocity and spin at the start
      real(wp) :: gravity(3) = 0.0_wp                 !! [m/s^2]
      real(wp) :: way(3) = [1.0_wp, 0.0_wp, 0.0_wp]   !! of the horizontal ground motion
      real(wp) :: domain = 0.0_wp                     !! displacement by which a body has left the scene [m]; 0: none
   contains
      procedure :: new_run
   end type built_solids

contains

   !> Bodies from flat arrays, see body_set_new, behind a handle
   subroutine solids_new(centroid, axes, mass, inertia, owner, vertex_first, vertex, face_first, loop_first, loop, &
                         handle, status)
      real(wp), intent(in) :: centroid(:, :)          !! (3, bodies) [m]
      real(wp), intent(in) :: axes(:, :, :)           !! (3, 3, bodies) columns: principal axes
      real(wp), intent(in) :: mass(:)                 !! (bodies) [kg]; 0 marks a support
      real(wp), intent(in) :: inertia(:, :)           !! (3, bodies) principal [kg m^2]
      integer(c_int), intent(in) :: owner(:)          !! (parts) 1-based
      integer(c_int), intent(in) :: vertex_first(:)   !! (parts + 1)
      real(wp), intent(in) :: vertex(:, :)            !! (3, vertices) in the principal axes [m]
      integer(c_int), intent(in) :: face_first(:)     !! (parts + 1)
      integer(c_int), intent(in) :: loop_first(:)     !! (faces + 1)
      integer(c_int), intent(in) :: loop(:)           !! vertices of the faces, 1-based
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: solids
      class(built_model), pointer :: built
      integer :: failed
      handle = 0
      status = status_out_of_memory
      allocate (solids, stat=failed)
      if (failed /= 0) return
      call body_set_new(centroid, axes, mass, inertia, owner, vertex_first, vertex, face_first, loop_first, loop, &
         solids%set, status)
      if (status == status_ok) then
         built => solids
         call model_register(built, handle, status)
      else
         deallocate (solids)
      end if
   end subroutine solids_new

   !> The solids of a handle, for this call alone, until handle_leave; null where the status is not ok
   subroutine solids_take(handle, solids, status)
      integer(c_int64_t), intent(in) :: handle
      type(built_solids), pointer, intent(out) :: solids
      integer(c_int), intent(out) :: status
      class(built_model), pointer :: built
      solids => null()
      call model_take(handle, built, status)
      if (status /= status_ok) return
      select type (built)
      type is (built_solids)
         solids => built
      class default
         status = status_wrong_handle
         call handle_leave(handle)
      end select
   end subroutine solids_take

   !> The last run of the solids of a handle, until handle_leave; null where the status is not ok
   subroutine solids_run_take(handle, run, status)
      integer(c_int64_t), intent(in) :: handle
      type(solid_simulation), pointer, intent(out) :: run
      integer(c_int), intent(out) :: status           !! not_ready where they have not run
      type(built_solids), pointer :: solids
      run => null()
      call solids_take(handle, solids, status)
      if (status /= status_ok) return
      if (allocated(solids%run)) then
         select type (last => solids%run)
         type is (solid_simulation)
            run => last
            return
         end select
      end if
      status = status_not_ready
      call handle_leave(handle)
   end subroutine solids_run_take

   !> Pairs of bodies whose joint is not of the first type
   subroutine set_joints(built, joint, status)
      type(built_solids), intent(inout) :: built
      integer(c_int), intent(in) :: joint(:, :)       !! (3, joints): bodies, the lower first, and law; ascending
      integer(c_int), intent(out) :: status
      integer, allocatable :: law_of(:, :)
      integer :: failed
      status = status_not_ready
      if (.not. allocated(built%law)) return
      status = status_bad_index
      if (any(joint < 1) .or. any(joint(1:2, :) > size(built%set%item)) .or. any(joint(3, :) > size(built%law))) return
      status = status_out_of_memory
      allocate (law_of(3, size(joint, 2)), stat=failed)
      if (failed /= 0) return
      law_of(:, :) = joint
      call move_alloc(law_of, built%law_of)
      built%highest_law = max(0, int(maxval(joint(3, :))))
      status = status_ok
   end subroutine set_joints

   !> Supports that move, without rotation
   subroutine set_moves(built, body, value, status)
      type(built_solids), intent(inout) :: built
      integer(c_int), intent(in) :: body(:)           !! (moves), 1-based
      real(wp), intent(in) :: value(:, :)             !! (5, moves) dx, dy, dz [m], start, duration [s]
      integer(c_int), intent(out) :: status
      call accept_moves(built%load, body, value, built%set%item%fixed, status)
   end subroutine set_moves

   !> Dowels across joints, from where they stand in space
   subroutine set_dowels(built, body, place, axis, value, status)
      type(built_solids), intent(inout) :: built
      integer(c_int), intent(in) :: body(:, :)        !! (2, dowels)
      real(wp), intent(in) :: place(:, :)             !! (3, dowels) [m]
      real(wp), intent(in) :: axis(:, :)              !! (3, dowels) from the first body to the second
      real(wp), intent(in) :: value(:, :)             !! (4, dowels) stiffness, strength, reach and damping, see dowel
      integer(c_int), intent(out) :: status
      type(dowel), allocatable :: found(:)
      integer :: k, side, failed
      status = status_bad_index
      if (any(body < 1) .or. any(body > size(built%set%item))) return
      status = status_invalid_argument
      if (any(body(1, :) == body(2, :))) return
      if (.not. (all(value(1:2, :) > 0.0_wp) .and. all(value(3:4, :) >= 0.0_wp))) return
      if (.not. all(abs(norm2(axis, dim=1) - 1.0_wp) < 1.0e-9_wp)) return
      status = status_out_of_memory
      allocate (found(size(body, 2)), stat=failed)
      if (failed /= 0) return
      do k = 1, size(found)
         associate (one => found(k), item => built%set%item)
            one%body = body(:, k)
            do side = 1, 2
               one%place(:, side) = matmul(place(:, k) - item(one%body(side))%x, item(one%body(side))%turn)
            end do
            one%axis = matmul(axis(:, k), item(one%body(1))%turn)
            one%stiffness = value(1, k)
            one%strength = value(2, k)
            one%reach = value(3, k)
            one%damping = value(4, k)
         end associate
      end do
      call move_alloc(found, built%dowels)
      status = status_ok
   end subroutine set_dowels

   !> Gravity, the way of the ground, how far the scene reaches, and velocities at the start
   subroutine set_surroundings(built, gravity, way, domain, rate, status)
      type(built_solids), intent(inout) :: built
      real(wp), intent(in) :: gravity(3)              !! [m/s^2]
      real(wp), intent(in) :: way(3)
      real(wp), intent(in) :: domain                  !! displacement [m]; 0: no limit
      real(wp), intent(in) :: rate(:, :)              !! (6, bodies) [m/s, rad/s]
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: rates(:, :)
      integer :: failed
      status = status_invalid_argument
      if (size(rate, 2) /= size(built%set%item) .or. .not. domain >= 0.0_wp) return
      status = status_out_of_memory
      allocate (rates(6, size(rate, 2)), stat=failed)
      if (failed /= 0) return
      rates(:, :) = rate
      call move_alloc(rates, built%rate)
      built%gravity = gravity
      built%way = way
      built%domain = domain
      status = status_ok
   end subroutine set_surroundings

   !> A run of a copy of what was built, before its first step
   subroutine new_run(built, wanted, status)
      class(built_solids), intent(inout) :: built
      real(wp), intent(in) :: wanted(:)               !! output times [s]
      integer(c_int), intent(out) :: status
      type(solid_simulation), allocatable :: run
      integer :: k, axis, failed, dowels
      status = status_not_ready
      if (.not. (allocated(built%law) .and. allocated(built%law_of) .and. allocated(built%rate))) return
      status = status_out_of_memory
      allocate (run, stat=failed)
      if (failed /= 0) return
      call run_record_new(size(built%set%item), 6, .true., count_ties(built), size(built%law_of, 2), &
         count_places(built%places), wanted, run%record, status)
      if (status /= status_ok) return
      associate (model => run%model)
         call copy_bodies(built%set, model%set, status)
         if (status /= status_ok) return
         dowels = 0
         if (allocated(built%dowels)) dowels = size(built%dowels)
         allocate (model%law(size(built%law)), model%law_of(3, size(built%law_of, 2)), model%dowels(dowels), &
            model%joint_loss(2, size(built%law_of, 2)), stat=failed)
         if (failed /= 0) status = status_out_of_memory
         if (failed /= 0) return
         if (dowels > 0) model%dowels(:) = built%dowels
         model%law(:) = built%law
         model%law_of(:, :) = built%law_of
         model%joint_loss = 0.0_wp
         if (allocated(built%load%move)) then
            allocate (model%load%move(size(built%load%move)), stat=failed)
            if (failed /= 0) status = status_out_of_memory
            if (failed /= 0) return
            model%load%move(:) = built%load%move
         end if
         call places_copy(built%places, model%places, status)
         if (status /= status_ok) return
         model%gravity = built%gravity
         model%way = built%way
         call set_rigid(model%rigid, model%model_clock, built%rigid, norm2(model%gravity), model%set%size, &
            sum(model%set%item%mass))
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (b%fixed) cycle
               b%v = built%rate(1:3, k)
               b%swing = 0.0_wp
               do axis = 1, 3
                  b%swing = b%swing &
                     + b%inertia(axis) * dot_product(b%turn(:, axis), built%rate(4:6, k)) * b%turn(:, axis)
               end do
            end associate
         end do
      end associate
      run%domain = built%domain
      call move_alloc(run, built%run)
   end subroutine new_run

end module dem3_handle
