!> The finite motion of a plane mechanism: rigid parts that turn about hinges, one degree of freedom.
!>
!> The coordinate q is the rotation of the driving part, counted in its sense. The places of the parts follow
!> from the coincidence of the hinge points by Newton's method; their first and second derivatives by q from
!> the derivatives of the same equations, so that nothing is differenced. The motion ends where the driving
!> part can turn no further: there the determinant of the equations changes its sign.
module mechanism_linkage
   use common_kinds, only : wp, gravity
   use common_status, only : status_ok, status_bad_geometry, status_invalid_argument, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: coordinate, copy_state, linkage, linkage_new, linkage_state, linkage_coefficients, linkage_path, &
      part_place

   !> What q is
   type :: coordinate
      integer :: driver = 1              !! the part whose rotation is q
      real(wp) :: sense = 1.0_wp         !! +1: the driver turns counter-clockwise for q > 0
      real(wp) :: sign_at_rest = 0.0_wp  !! of the determinant of the equations; 0 until known
   end type coordinate

   type :: linkage
      integer :: parts = 0                     !! moving rigid parts; 0 names the ground
      real(wp) :: size = 1.0_wp                !! scale of lengths [m]
      type(coordinate) :: by                   !! the degree of freedom
      real(wp), allocatable :: mass(:)         !! (parts) [kg]
      real(wp), allocatable :: centroid(:, :)  !! (2, parts) at rest [m]
      real(wp), allocatable :: inertia(:)      !! (parts) about the centroids [kg m^2]
      integer, allocatable :: side(:, :)       !! (2, hinges) the parts that a hinge joins
      real(wp), allocatable :: point(:, :)     !! (2, hinges) at rest [m]
      integer, allocatable :: row(:, :)        !! (2, 3 parts - 1) hinge and axis of the independent equations
   contains
      procedure :: close_hinges
      procedure :: advance_state
      procedure :: carry_state
   end type linkage

   !> Where the parts are at q, and how they move
   type :: linkage_state
      real(wp) :: q = 0.0_wp
      logical :: closed = .false.            !! the hinges can be closed at this q
      real(wp) :: determinant = 0.0_wp       !! sign of the determinant of the equations
      real(wp), allocatable :: place(:, :)   !! (3, parts) centroid x, y [m], rotation [rad]
      real(wp), allocatable :: first(:, :)   !! its derivative by q
      real(wp), allocatable :: second(:, :)  !! its second derivative
   end type linkage_state

   integer, parameter :: most_iterations = 30
   !> Misfit of the hinges, as a share of the size, at which they count as closed
   real(wp), parameter :: closed_to = 1.0e-13_wp
   !> The same for equations that depend on the others: there rounding adds up along the chain
   real(wp), parameter :: closed_apart = 1.0e-9_wp
   !> Steps are halved at most this often before the hinges count as apart
   integer, parameter :: most_halvings = 6

   interface
      subroutine dgetrf(m, n, a, lda, ipiv, info)
         import :: wp
         implicit none (type, external)
         integer, intent(in) :: m, n, lda
         real(wp), intent(inout) :: a(lda, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgetrf

      subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         implicit none (type, external)
         character, intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgetrs
   end interface

contains

   !> Set up a mechanism and its state at rest
   subroutine linkage_new(mass, centroid, inertia, side, point, row, driver, sense, built, rest, status)
      real(wp), intent(in) :: mass(:)         !! (parts) [kg]
      real(wp), intent(in) :: centroid(:, :)  !! (2, parts) [m]
      real(wp), intent(in) :: inertia(:)      !! (parts) about the centroids [kg m^2]
      integer(c_int), intent(in) :: side(:, :)  !! (2, hinges) parts that a hinge joins, 0 = ground
      real(wp), intent(in) :: point(:, :)     !! (2, hinges) [m]
      integer(c_int), intent(in) :: row(:, :)  !! (2, 3 parts - 1) hinge and axis, from 1, of the independent equations
      integer(c_int), intent(in) :: driver    !! the part whose rotation is q
      real(wp), intent(in) :: sense           !! +1 or -1, see linkage
      type(linkage), intent(out) :: built
      type(linkage_state), intent(out) :: rest
      integer(c_int), intent(out) :: status   !! status_bad_geometry where the equations do not fix the motion
      integer :: n, stat

      n = size(mass)
      status = status_invalid_argument
      if (n < 1 .or. size(row, 2) /= 3 * n - 1 .or. driver < 1 .or. driver > n) return
      if (any(side < 0) .or. any(side > n) .or. any(row(1, :) < 1) .or. any(row(1, :) > size(side, 2))) return
      if (any(row(2, :) < 1) .or. any(row(2, :) > 2)) return
      if (any(mass <= 0.0_wp) .or. any(inertia < 0.0_wp) .or. abs(abs(sense) - 1.0_wp) > 0.0_wp) return
      built%parts = n
      built%by = coordinate(driver, sense)
      allocate (built%mass(n), built%centroid(2, n), built%inertia(n), built%side(2, size(side, 2)), &
         built%point(2, size(point, 2)), built%row(2, size(row, 2)), &
         rest%place(3, n), rest%first(3, n), rest%second(3, n), stat=stat)
      if (stat /= 0) then
         status = status_out_of_memory
         return
      end if
      built%mass(:) = mass
      built%centroid(:, :) = centroid
      built%inertia(:) = inertia
      built%side(:, :) = side
      built%point(:, :) = point
      built%row(:, :) = row
      built%size = max(maxval(centroid(1, :)), maxval(point(1, :))) - min(minval(centroid(1, :)), minval(point(1, :)))
      built%size = max(built%size, max(maxval(centroid(2, :)), maxval(point(2, :))) &
         - min(minval(centroid(2, :)), minval(point(2, :))))
      rest%place(1:2, :) = centroid
      rest%place(3, :) = 0.0_wp
      call built%close_hinges(built%by, rest, status)
      if (status == status_ok .and. .not. rest%closed) status = status_bad_geometry
      if (status == status_ok) built%by%sign_at_rest = rest%determinant
   end subroutine linkage_new

   !> A copy of a state. The assignment of the language would end the process where memory fails.
   pure subroutine copy_state(from, to, status)
      type(linkage_state), intent(in) :: from
      type(linkage_state), intent(inout) :: to  !! empty, or a state of the same linkage
      integer(c_int), intent(out) :: status     !! status_out_of_memory, else ok
      integer :: stat

      stat = 0
      if (.not. allocated(to%second)) allocate (to%place, to%first, to%second, mold=from%place, stat=stat)
      status = merge(status_ok, status_out_of_memory, stat == 0)
      if (stat /= 0) return
      to%q = from%q
      to%closed = from%closed
      to%determinant = from%determinant
      to%place(:, :) = from%place
      to%first(:, :) = from%first
      to%second(:, :) = from%second
   end subroutine copy_state

   !> Carry a state on to another coordinate; status_bad_geometry where the hinges do not close there
   subroutine carry_state(chain, state, q, status)
      class(linkage), intent(in) :: chain
      type(linkage_state), intent(inout) :: state
      real(wp), intent(in) :: q              !! [rad]
      integer(c_int), intent(out) :: status
      type(linkage_state) :: there

      call chain%advance_state(state, q, there, status)
      if (status /= status_ok) return
      if (.not. there%closed) then
         status = status_bad_geometry
         return
      end if
      call copy_state(there, state, status)
   end subroutine carry_state

   !> Close the hinges at state%q, starting from the places given, and find the derivatives
   subroutine close_hinges(chain, by, state, status)
      class(linkage), intent(in) :: chain
      type(coordinate), intent(in) :: by     !! what q is
      type(linkage_state), intent(inout) :: state
      integer(c_int), intent(out) :: status  !! status_out_of_memory, else ok: see state%closed
      real(wp), allocatable :: matrix(:, :), right(:)
      integer, allocatable :: pivot(:)
      real(wp) :: change, misfit, misfit_before
      integer :: n, iteration, info, stat, k

      n = 3 * chain%parts
      state%closed = .false.
      allocate (matrix(n, n), right(n), pivot(n), stat=stat)
      status = merge(status_ok, status_out_of_memory, stat == 0)
      if (stat /= 0) return
      change = huge(change)
      misfit_before = huge(misfit)
      do iteration = 1, most_iterations
         call form_equations(chain, by, state, matrix, right)
         misfit = maxval(abs(right))
         if (.not. misfit <= huge(misfit)) return
         call dgetrf(n, n, matrix, n, pivot, info)
         if (info /= 0) return
         ! On until rounding rules: near the lock what is left of the misfit counts with its square root.
         if (change <= 1.0e-6_wp .and. misfit <= closed_to .and. misfit >= 0.25_wp * misfit_before) exit
         misfit_before = misfit
         call dgetrs('N', n, 1, matrix, n, pivot, right, n, info)
         change = maxval(abs(right))
         if (.not. change <= 1.0_wp) return
         call move_places(chain, right, state)
      end do
      if (iteration > most_iterations) return
      if (parted(chain, state) > closed_apart) return
      state%determinant = determinant_sign(matrix, pivot)
      if (by%sign_at_rest * state%determinant < 0.0_wp) return  ! past the lock, on another branch

      right = 0.0_wp
      right(n) = by%sense
      call dgetrs('N', n, 1, matrix, n, pivot, right, n, info)
      do k = 1, chain%parts
         state%first(1:2, k) = right(3 * k - 2:3 * k - 1) * chain%size
         state%first(3, k) = right(3 * k)
      end do
      call form_centripetal_side(chain, state, right)
      call dgetrs('N', n, 1, matrix, n, pivot, right, n, info)
      do k = 1, chain%parts
         state%second(1:2, k) = right(3 * k - 2:3 * k - 1) * chain%size
         state%second(3, k) = right(3 * k)
      end do
      state%closed = .true.
   end subroutine close_hinges

   !> Carry the mechanism from a state to another q; steps that do not close are halved a few times
   subroutine advance_state(chain, from, q, to, status)
      class(linkage), intent(in) :: chain
      type(linkage_state), intent(in) :: from   !! closed
      real(wp), intent(in) :: q                 !! [rad]
      type(linkage_state), intent(inout) :: to  !! see copy_state; to%closed is false where q is out of reach
      integer(c_int), intent(out) :: status     !! status_out_of_memory, else ok
      type(linkage_state) :: here
      real(wp) :: step
      integer :: halvings

      call copy_state(from, here, status)
      if (status /= status_ok) return
      call copy_state(from, to, status)
      if (status /= status_ok) return
      step = q - from%q
      halvings = 0
      do
         to%q = merge(q, here%q + step, halvings == 0 .or. abs(q - here%q) <= abs(step))
         to%place(:, :) = here%place + (to%q - here%q) * (here%first + 0.5_wp * (to%q - here%q) * here%second)
         call chain%close_hinges(chain%by, to, status)
         if (status /= status_ok) return
         if (to%closed) then
            if (abs(to%q - q) <= 0.0_wp) return
            call copy_state(to, here, status)
            if (status /= status_ok) return
         else
            halvings = halvings + 1
            if (halvings > most_halvings) return
            step = 0.5_wp * step
         end if
      end do
   end subroutine advance_state

   !> States at ascending q, reached in short steps from rest so that the branch is kept
   subroutine linkage_path(mechanism, rest, q, place, first, second, reached, status)
      type(linkage), intent(in) :: mechanism
      type(linkage_state), intent(in) :: rest
      real(wp), intent(in) :: q(:)               !! ascending [rad]
      real(wp), intent(inout) :: place(:, :, :)   !! (3, parts, size(q)), see linkage_state
      real(wp), intent(inout) :: first(:, :, :)
      real(wp), intent(inout) :: second(:, :, :)
      integer(c_int), intent(out) :: reached     !! how many before the hinges part
      integer(c_int), intent(out) :: status
      real(wp), parameter :: longest = 4.0e-3_wp  ! [rad]
      type(linkage_state) :: here, next
      integer :: k, pieces, piece

      reached = 0
      call copy_state(rest, here, status)
      if (status /= status_ok) return
      do k = 1, size(q)
         pieces = max(1, ceiling(abs(q(k) - here%q) / longest))
         do piece = pieces - 1, 0, -1
            call mechanism%advance_state(here, q(k) - piece * (q(k) - here%q) / (piece + 1), next, status)
            if (status /= status_ok .or. .not. next%closed) return
            call copy_state(next, here, status)
            if (status /= status_ok) return
         end do
         place(:, :, k) = here%place
         first(:, :, k) = here%first
         second(:, :, k) = here%second
         reached = int(k, c_int)
      end do
   end subroutine linkage_path

   !> The equations, divided by the size of the mechanism, and what is still missing to fulfil them
   pure subroutine form_equations(chain, by, state, matrix, missing)
      type(linkage), intent(in) :: chain
      type(coordinate), intent(in) :: by
      type(linkage_state), intent(in) :: state
      real(wp), intent(out) :: matrix(:, :)  !! by the places over the size, and the rotations
      real(wp), intent(out) :: missing(:)
      real(wp) :: place(2, 2), lever(2, 2)
      integer :: r, h, axis, k, part, column

      matrix = 0.0_wp
      do r = 1, size(chain%row, 2)
         h = chain%row(1, r)
         axis = chain%row(2, r)
         do k = 1, 2
            part = chain%side(k, h)
            place(:, k) = part_place(chain, state, part, chain%point(:, h))
            if (part == 0) cycle
            lever(:, k) = place(:, k) - state%place(1:2, part)
            column = 3 * (part - 1)
            ! The first side counts positive, the second negative.
            matrix(r, column + axis) = matrix(r, column + axis) + real(3 - 2 * k, wp)
            matrix(r, column + 3) = matrix(r, column + 3) + real(3 - 2 * k, wp) &
               * merge(-lever(2, k), lever(1, k), axis == 1) / chain%size
         end do
         missing(r) = (place(axis, 2) - place(axis, 1)) / chain%size
      end do
      r = 3 * chain%parts
      matrix(r, 3 * by%driver) = 1.0_wp
      missing(r) = by%sense * state%q - state%place(3, by%driver)
   end subroutine form_equations

   !> Right-hand side of the second derivatives: the centripetal part of the hinge points
   pure subroutine form_centripetal_side(chain, state, right)
      type(linkage), intent(in) :: chain
      type(linkage_state), intent(in) :: state
      real(wp), intent(out) :: right(:)
      real(wp) :: place(2)
      integer :: r, h, axis, k, part

      right = 0.0_wp
      do r = 1, size(chain%row, 2)
         h = chain%row(1, r)
         axis = chain%row(2, r)
         do k = 1, 2
            part = chain%side(k, h)
            if (part == 0) cycle
            place = part_place(chain, state, part, chain%point(:, h))
            right(r) = right(r) + real(3 - 2 * k, wp) * state%first(3, part)**2 &
               * (place(axis) - state%place(axis, part)) / chain%size
         end do
      end do
   end subroutine form_centripetal_side

   !> Add a step of the unknowns to the places
   pure subroutine move_places(chain, step, state)
      type(linkage), intent(in) :: chain
      real(wp), intent(in) :: step(:)
      type(linkage_state), intent(inout) :: state
      integer :: k
      do k = 1, chain%parts
         state%place(1:2, k) = state%place(1:2, k) + chain%size * step(3 * k - 2:3 * k - 1)
         state%place(3, k) = state%place(3, k) + step(3 * k)
      end do
   end subroutine move_places

   !> Greatest misfit of all hinges, also of the equations that depend on others, as a share of the size
   pure function parted(chain, state) result(apart)
      type(linkage), intent(in) :: chain
      type(linkage_state), intent(in) :: state
      real(wp) :: apart
      integer :: h
      apart = 0.0_wp
      do h = 1, size(chain%side, 2)
         apart = max(apart, norm2(part_place(chain, state, chain%side(1, h), chain%point(:, h)) &
            - part_place(chain, state, chain%side(2, h), chain%point(:, h))) / chain%size)
      end do
   end function parted

   !> Sign of the determinant from its factors
   pure function determinant_sign(factors, pivot) result(s)
      real(wp), intent(in) :: factors(:, :)
      integer, intent(in) :: pivot(:)
      real(wp) :: s
      integer :: k
      s = 1.0_wp
      do k = 1, size(pivot)
         if ((factors(k, k) < 0.0_wp) .neqv. (pivot(k) /= k)) s = -s
      end do
   end function determinant_sign

   !> Where a point of a part (0: the ground), given at rest, lies now
   pure function part_place(chain, state, part, point) result(place)
      type(linkage), intent(in) :: chain
      type(linkage_state), intent(in) :: state
      integer, intent(in) :: part
      real(wp), intent(in) :: point(2)
      real(wp) :: place(2)
      real(wp) :: arm(2), c, s
      place = point
      if (part == 0) return
      arm = point - chain%centroid(:, part)
      c = cos(state%place(3, part))
      s = sin(state%place(3, part))
      place = state%place(1:2, part) + [c * arm(1) - s * arm(2), s * arm(1) + c * arm(2)]
   end function part_place

   !> Coefficients of M q'' + (1/2) M' q'^2 + V' (1 + a_v/g) + side a_h H = 0 at a closed state (thesis Eqs 5.1, B.2)
   !>
   !> H counts positive to +x for both sides of motion; the rocker's H is side times it.
   pure subroutine linkage_coefficients(chain, state, m, half_dm, dv, dh, v)
      type(linkage), intent(in) :: chain
      type(linkage_state), intent(in) :: state
      real(wp), intent(out) :: m        !! generalised mass M [kg m^2]
      real(wp), intent(out) :: half_dm  !! (1/2) dM/dq [kg m^2]
      real(wp), intent(out) :: dv       !! dV/dq of gravity [N m]
      real(wp), intent(out) :: dh       !! sum m dx/dq [kg m]
      real(wp), intent(out) :: v        !! potential energy above rest [J]
      integer :: k

      m = 0.0_wp
      half_dm = 0.0_wp
      dv = 0.0_wp
      dh = 0.0_wp
      v = 0.0_wp
      do k = 1, chain%parts
         m = m + chain%mass(k) * sum(state%first(1:2, k)**2) + chain%inertia(k) * state%first(3, k)**2
         half_dm = half_dm + chain%mass(k) * dot_product(state%first(1:2, k), state%second(1:2, k)) &
            + chain%inertia(k) * state%first(3, k) * state%second(3, k)
         dv = dv + gravity * chain%mass(k) * state%first(2, k)
         dh = dh + chain%mass(k) * state%first(1, k)
         v = v + gravity * chain%mass(k) * (state%place(2, k) - chain%centroid(2, k))
      end do
   end subroutine linkage_coefficients

end module mechanism_linkage
