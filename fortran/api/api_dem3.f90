!> Discrete elements in space: blocks behind a handle, built in steps, and what a run leaves of them.
!>
!> create, laws (api_dem_run), joints, moves, dowels and loads if any, surroundings; then the run (api_dem_run); then bodies,
!> attitudes, slips.
!> Body numbers are 1-based; mass 0 marks a support.
module api_dem3
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: create, joints, moves, dowels, loads, surroundings, bodies, attitudes, slips

contains

   !> Bodies made of convex polyhedra
   subroutine create(nb, npart, nvert, nface, nloop, centroid, axes, mass, parts, vertex, loop_first, loop, handle, &
                     status)
      use dem3_handle, only : solids_new
      integer(c_int), intent(in) :: nb                        !! bodies
      integer(c_int), intent(in) :: npart                     !! convex parts
      integer(c_int), intent(in) :: nvert                     !! vertices of all parts
      integer(c_int), intent(in) :: nface                     !! faces of all parts
      integer(c_int), intent(in) :: nloop                     !! vertices of all faces
      real(c_double), intent(in) :: centroid(3, nb)           !! [m]
      real(c_double), intent(in) :: axes(3, 3, nb)            !! columns: principal axes
      real(c_double), intent(in) :: mass(4, nb)               !! [kg], and principal inertia [kg m^2]
      integer(c_int), intent(in) :: parts(3, npart + 1)       !! body, first vertex, first face; last column: ends
      real(c_double), intent(in) :: vertex(3, nvert)          !! in the principal axes of the body [m]
      integer(c_int), intent(in) :: loop_first(nface + 1)     !! first vertex of each face
      integer(c_int), intent(in) :: loop(nloop)               !! vertices of the faces, counter-clockwise from outside
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      call solids_new(centroid, axes, mass(1, :), mass(2:4, :), parts(1, 1:npart), parts(2, :), vertex, parts(3, :), &
         loop_first, loop, handle, status)
   end subroutine create

   !> Pairs of bodies whose joint has a type of its own
   subroutine joints(handle, njoint, joint, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem3_handle, only : built_solids, set_joints, solids_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: njoint
      integer(c_int), intent(in) :: joint(3, njoint)          !! two bodies, the lower first, and the law; ascending
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      call solids_take(handle, built, status)
      if (status /= status_ok) return
      call set_joints(built, joint, status)
      call handle_leave(handle)
   end subroutine joints

   !> Supports that move, without rotation
   subroutine moves(handle, nmove, body, move, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem3_handle, only : built_solids, set_moves, solids_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nmove
      integer(c_int), intent(in) :: body(nmove)               !! support that moves
      real(c_double), intent(in) :: move(5, nmove)            !! dx, dy, dz [m], start, duration [s]
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      call solids_take(handle, built, status)
      if (status /= status_ok) return
      call set_moves(built, body, move, status)
      call handle_leave(handle)
   end subroutine moves

   !> Dowels across joints
   subroutine dowels(handle, n, body, place, axis, value, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem3_handle, only : built_solids, set_dowels, solids_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n
      integer(c_int), intent(in) :: body(2, n)                !! that it stands in, and that it reaches into
      real(c_double), intent(in) :: place(3, n)               !! [m]
      real(c_double), intent(in) :: axis(3, n)                !! from the first body to the second
      real(c_double), intent(in) :: value(4, n)               !! stiffness [N/m], strength [N], reach [m], damping [s]
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      call solids_take(handle, built, status)
      if (status /= status_ok) return
      call set_dowels(built, body, place, axis, value, status)
      call handle_leave(handle)
   end subroutine dowels

   !> Constant loads
   subroutine loads(handle, nb, load, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem3_handle, only : built_solids, solids_take
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      real(c_double), intent(in) :: load(3, 4, nb)            !! force [N]; arm in own axes times force x, y, z [N m]
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      integer :: k
      call solids_take(handle, built, status)
      if (status /= status_ok) return
      if (nb /= size(built%set%item)) status = status_invalid_argument
      if (status == status_ok) then
         do k = 1, nb
            built%set%item(k)%load = load(:, 1, k)
            built%set%item(k)%load_arm = load(:, 2:4, k)
         end do
      end if
      call handle_leave(handle)
   end subroutine loads

   !> Gravity, the direction of horizontal ground motion, the scene, and velocities at the start
   subroutine surroundings(handle, gravity, way, domain, nb, rate, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok
      use dem3_handle, only : built_solids, set_surroundings, solids_take
      integer(c_int64_t), intent(in) :: handle
      real(c_double), intent(in) :: gravity(3)                !! [m/s^2]
      real(c_double), intent(in) :: way(3)
      real(c_double), intent(in) :: domain                    !! displacement by which a body has left it [m]; 0: none
      integer(c_int), intent(in) :: nb                        !! bodies
      real(c_double), intent(in) :: rate(6, nb)               !! [m/s, rad/s]
      integer(c_int), intent(out) :: status
      type(built_solids), pointer :: built
      call solids_take(handle, built, status)
      if (status /= status_ok) return
      call set_surroundings(built, gravity, way, domain, rate, status)
      call handle_leave(handle)
   end subroutine surroundings

   !> Where the bodies had settled in the last run, and how they left what they touched
   subroutine bodies(handle, nb, place, turn, bounces, airborne, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem3_handle, only : solids_run_take
      use dem3_run, only : solid_simulation
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      real(c_double), intent(out) :: place(3, nb)             !! settled centroids [m]
      real(c_double), intent(out) :: turn(3, 3, nb)           !! settled axes in the columns
      integer(c_int), intent(out) :: bounces(nb)              !! times that each left all that it touched
      real(c_double), intent(out) :: airborne(nb)             !! time without contact [s]
      integer(c_int), intent(out) :: status
      type(solid_simulation), pointer :: run
      integer :: k
      place = 0.0_c_double
      turn = 0.0_c_double
      bounces = 0
      airborne = 0.0_c_double
      call solids_run_take(handle, run, status)
      if (status /= status_ok) return
      associate (item => run%model%set%item)
         status = merge(status_ok, status_invalid_argument, nb == size(item))
         if (status == status_ok) then
            do k = 1, nb
               place(:, k) = item(k)%rest
               turn(:, :, k) = item(k)%rest_turn
            end do
            bounces = int(item%bounces, c_int)
            airborne = item%airborne
         end if
      end associate
      call handle_leave(handle)
   end subroutine bodies

   !> How the bodies lay at the points of the last run's history
   subroutine attitudes(handle, nb, nt, turn, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem3_handle, only : solids_run_take
      use dem3_run, only : solid_simulation
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: nb                        !! bodies
      integer(c_int), intent(in) :: nt                        !! points, see api_dem_run
      real(c_double), intent(out) :: turn(3, 3, nb, nt)       !! columns: principal axes
      integer(c_int), intent(out) :: status
      type(solid_simulation), pointer :: run
      turn = 0.0_c_double
      call solids_run_take(handle, run, status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if (nb == size(run%record%turn, 3) .and. nt <= run%record%points) then
         status = status_ok
         turn = run%record%turn(:, :, :, 1:nt)
      end if
      call handle_leave(handle)
   end subroutine attitudes

   !> What became of the dowels in the last run
   subroutine slips(handle, n, slip, is_out, status)
      use common_handles, only : handle_leave
      use common_status, only : status_ok, status_invalid_argument
      use dem3_handle, only : solids_run_take
      use dem3_run, only : solid_simulation
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: n                         !! dowels
      real(c_double), intent(out) :: slip(n)                  !! farthest that each gave way [m]
      integer(c_int), intent(out) :: is_out(n)                !! 1: the stones have parted farther than it reaches
      integer(c_int), intent(out) :: status
      type(solid_simulation), pointer :: run
      slip = 0.0_c_double
      is_out = 0
      call solids_run_take(handle, run, status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if (n == size(run%model%dowels)) then
         status = status_ok
         slip = run%model%dowels%most_slip
         is_out = merge(1, 0, run%model%dowels%is_out)
      end if
      call handle_leave(handle)
   end subroutine slips

end module api_dem3
