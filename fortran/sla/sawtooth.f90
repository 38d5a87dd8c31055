!> Saw-tooth approximations of a softening law (thesis 4.2, Fig. 4-1b).
!>
!> A tooth is a secant modulus E_i with the peak stress f_i that ends it. Two recipes: the ripple (Rots,
!> Belletti, Invernizzi 2008), whose teeth run between two lines at +-p ft about the law, and the
!> energy-exact teeth, whose peaks lie on the same upper line while each secant carries exactly the energy
!> of its strain interval.
!>
!> Laws of a band of width h, energy Gf/h per volume: linear to the ultimate strain 2 Gf / (ft h) (thesis Eq. 4.1);
!> exponential, ft exp(-(eps - eps_0) / eps_f) with eps_f = Gf / (ft h) - eps_0 / 2; Hordijk (1991), below; yielding, a
!> plateau at ft that breaks at the strain Gf / (ft h) + eps_0 / 2. Ripple:
!> tooth i ends at f_i = sigma(eps_i) + p ft and the next begins at f_i - 2 p ft, so E_(i+1) = (f_i - 2 p ft) / eps_i.
!> Energy-exact (our own): a secant E_1 = f_1 / eps_1 reached from strain eps_0 dissipates
!> f_1 (eps_1 - eps_0^2 / eps_1) / 2, set equal to the area of the law between them.
!>
!> Curves are followed by a parameter x: the total strain, or the crack strain of Hordijk's law, in which it is
!> explicit.
module sla_sawtooth
   use common_kinds, only : wp
   use common_lists, only : law_linear => sla_law_linear, law_exponential => sla_law_exponential, &
      law_hordijk => sla_law_hordijk, law_yielding => sla_law_yielding
   use common_status, only : status_ok, status_invalid_argument, status_snap_back, status_too_many_steps
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: softening, softening_new, make_teeth, largest_band

   !> Hordijk (1991): (1 + (c1 x)^3) exp(-c2 x) - x (1 + c1^3) exp(-c2), x = crack strain / ultimate
   real(wp), parameter :: c1 = 3.0_wp, c2 = 6.93_wp
   real(wp), parameter :: hordijk_area = 5.136_wp   !! ultimate opening times ft over Gf

   !> Teeth end where the lower line falls below this part of ft
   real(wp), parameter :: least_stress = 1.0e-3_wp

   !> Stress-strain law of a band of width h
   type :: softening
      integer(c_int) :: kind = law_linear
      real(wp) :: e = 0.0_wp      !! modulus [Pa]
      real(wp) :: ft = 0.0_wp     !! strength [Pa]
      real(wp) :: peak = 0.0_wp   !! strain at the strength
      real(wp) :: range = 0.0_wp  !! ultimate strain, decay strain, or ultimate crack strain
      real(wp) :: total = 0.0_wp  !! energy to complete failure [J/m^3]
      logical :: clipped = .true. !! the linear law stops at zero stress
   contains
      procedure :: first
      procedure :: strain
      procedure :: stress
      procedure :: energy
      procedure :: secant
      procedure :: slope
      procedure :: lost
      procedure :: strain_at
      procedure :: progress
      procedure :: strain_of
   end type softening

contains

   !> Largest crack band width for which the law does not snap back [m]
   pure function largest_band(kind, e, ft, gf) result(h)
      integer(c_int), intent(in) :: kind
      real(wp), intent(in) :: e   !! [Pa]
      real(wp), intent(in) :: ft  !! [Pa]
      real(wp), intent(in) :: gf  !! [N/m]
      real(wp) :: h
      h = 2.0_wp * e * gf / ft**2
      if (kind == law_hordijk) h = hordijk_area * e * gf / (ft**2 * (c2 + (1.0_wp + c1**3) * exp(-c2)))
   end function largest_band

   !> The law of a band of width h
   pure subroutine softening_new(kind, e, ft, gf, h, law, status)
      integer(c_int), intent(in) :: kind     !! law_linear, law_exponential, law_hordijk
      real(wp), intent(in) :: e              !! [Pa]
      real(wp), intent(in) :: ft             !! [Pa]
      real(wp), intent(in) :: gf             !! [N/m]
      real(wp), intent(in) :: h              !! [m]
      type(softening), intent(out) :: law
      integer(c_int), intent(out) :: status  !! status_snap_back where h is too large

      status = status_invalid_argument
      if (.not. (e > 0.0_wp .and. ft > 0.0_wp .and. gf > 0.0_wp .and. h > 0.0_wp)) return
      if (kind < law_linear .or. kind > law_hordijk) return
      status = status_snap_back
      if (.not. h < largest_band(kind, e, ft, gf)) return
      law%kind = kind
      law%e = e
      law%ft = ft
      law%peak = ft / e
      select case (kind)
      case (law_linear)
         law%range = 2.0_wp * gf / (ft * h)
         law%total = gf / h
      case (law_exponential)
         law%range = gf / (ft * h) - 0.5_wp * law%peak
         law%total = gf / h
      case default
         law%range = hordijk_area * gf / (ft * h)
         law%total = ft * law%range * hordijk_integral(1.0_wp)
      end select
      status = status_ok
   end subroutine softening_new

   !> Parameter at the peak
   pure function first(law) result(x)
      class(softening), intent(in) :: law
      real(wp) :: x
      x = merge(0.0_wp, law%peak, law%kind == law_hordijk)
   end function first

   !> Total strain at parameter x, beyond the peak
   pure function strain(law, x) result(eps)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: x
      real(wp) :: eps
      eps = x
      if (law%kind == law_hordijk) eps = x + law%stress(x) / law%e
   end function strain

   !> Stress at parameter x, beyond the peak [Pa]
   pure function stress(law, x) result(sigma)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: x
      real(wp) :: sigma, r
      select case (law%kind)
      case (law_linear)
         sigma = law%ft * (law%range - x) / (law%range - law%peak)
         if (law%clipped) sigma = max(sigma, 0.0_wp)
      case (law_exponential)
         sigma = law%ft * exp(-(x - law%peak) / law%range)
      case default
         r = min(x / law%range, 1.0_wp)
         sigma = max(law%ft * ((1.0_wp + (c1 * r)**3) * exp(-c2 * r) - r * (1.0_wp + c1**3) * exp(-c2)), 0.0_wp)
      end select
   end function stress

   !> Area under the law up to parameter x, the elastic branch included [J/m^3]
   pure function energy(law, x) result(area)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: x
      real(wp) :: area, sigma
      select case (law%kind)
      case (law_linear)
         sigma = law%stress(x)
         area = law%total - 0.5_wp * sigma * (law%range - x)
      case (law_exponential)
         area = law%total - law%stress(x) * law%range
      case default
         area = law%ft * law%range * hordijk_integral(min(x / law%range, 1.0_wp)) &
            + 0.5_wp * law%stress(x)**2 / law%e
      end select
   end function energy

   !> Parameter of a total strain beyond the peak
   pure function parameter_of(law, eps) result(x)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: eps
      real(wp) :: x, low, high
      integer :: k
      x = eps
      if (law%kind /= law_hordijk) return
      low = 0.0_wp
      high = eps
      do k = 1, 100    ! the strain grows with the crack strain, as the law does not snap back
         x = 0.5_wp * (low + high)
         if (x <= low .or. x >= high) exit
         if (law%strain(x) < eps) then
            low = x
         else
            high = x
         end if
      end do
   end function parameter_of

   !> Secant modulus once the total strain `eps` has been reached [Pa]
   pure function secant(law, eps) result(modulus)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: eps
      real(wp) :: modulus
      modulus = law%e
      if (eps > law%peak) modulus = law%stress(parameter_of(law, eps)) / eps
   end function secant

   !> Slope of the law at the total strain `eps` [Pa]
   pure function slope(law, eps) result(modulus)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: eps
      real(wp) :: modulus, step, x
      modulus = law%e
      if (eps <= law%peak) return
      select case (law%kind)
      case (law_linear)
         modulus = merge(-law%ft / (law%range - law%peak), 0.0_wp, eps < law%range)
      case (law_exponential)
         modulus = -law%stress(eps) / law%range
      case default
         x = parameter_of(law, eps)
         step = 1.0e-6_wp * law%range
         modulus = (law%stress(x + step) - law%stress(x)) / (law%strain(x + step) - law%strain(x))
      end select
   end function slope

   !> Energy lost once the total strain `eps` has been reached: the area under the law less what the secant stores
   !> [J/m^3]
   pure function lost(law, eps) result(area)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: eps
      real(wp) :: area, x
      area = 0.0_wp
      if (eps <= law%peak) return
      x = parameter_of(law, eps)
      if (law%kind == law_linear) x = min(x, law%range)
      area = law%energy(x) - 0.5_wp * law%stress(x) * eps
   end function lost

   !> Total strain that leaves a secant modulus, 0 for the whole one
   pure function strain_at(law, modulus) result(eps)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: modulus      !! [Pa]
      real(wp) :: eps, low, high
      integer :: k
      eps = 0.0_wp
      if (modulus >= law%e) return
      low = law%peak
      high = 2.0_wp * law%peak
      do k = 1, 1000
         if (law%secant(high) <= modulus) exit
         low = high
         high = 1.5_wp * high
      end do
      do k = 1, 100
         eps = 0.5_wp * (low + high)
         if (eps <= low .or. eps >= high) exit
         if (law%secant(eps) > modulus) then
            low = eps
         else
            high = eps
         end if
      end do
   end function strain_at

   !> How far a total strain has gone along the softening branch, in parts of the range: 0 up to the peak. Laws of one
   !> kind have the same part of their strengths left at the same progress
   pure function progress(law, eps) result(x)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: eps
      real(wp) :: x
      x = 0.0_wp
      if (eps > law%peak) x = (parameter_of(law, eps) - law%first()) / span(law)
   end function progress

   !> Total strain at a progress
   pure function strain_of(law, x) result(eps)
      class(softening), intent(in) :: law
      real(wp), intent(in) :: x
      real(wp) :: eps
      eps = law%strain(law%first() + x * span(law))
   end function strain_of

   !> Parameter from the peak to the end of the linear law, the decay, or Hordijk's ultimate crack strain
   pure function span(law) result(length)
      class(softening), intent(in) :: law
      real(wp) :: length
      length = merge(law%range - law%peak, law%range, law%kind == law_linear)
   end function span

   !> Integral of Hordijk's curve from 0 to r, both axes relative
   pure function hordijk_integral(r) result(area)
      real(wp), intent(in) :: r
      real(wp) :: area
      area = primitive(r) - primitive(0.0_wp) - 0.5_wp * r**2 * (1.0_wp + c1**3) * exp(-c2)
   contains
      pure function primitive(y) result(f)
         real(wp), intent(in) :: y
         real(wp) :: f
         f = -exp(-c2 * y) * (1.0_wp / c2 + c1**3 * (y**3 / c2 + 3.0_wp * y**2 / c2**2 + 6.0_wp * y / c2**3 + &
            6.0_wp / c2**4))
      end function primitive
   end function hordijk_integral

   !> Parameter beyond `from` where the ray of modulus `ray` meets the upper line
   pure function meets_upper(law, ray, p, from) result(x)
      type(softening), intent(in) :: law
      real(wp), intent(in) :: ray   !! [Pa]
      real(wp), intent(in) :: p     !! ripple half-width over ft
      real(wp), intent(in) :: from
      real(wp) :: x, low, high
      integer :: k
      low = from
      high = max(from, law%peak)
      do k = 1, 2000
         if (ray * law%strain(high) >= law%stress(high) + p * law%ft) exit
         low = high
         high = 1.2_wp * high
      end do
      do k = 1, 200
         x = 0.5_wp * (low + high)
         if (x <= low .or. x >= high) exit
         if (ray * law%strain(x) < law%stress(x) + p * law%ft) then
            low = x
         else
            high = x
         end if
      end do
   end function meets_upper

   !> Teeth of a law: secant moduli and the stresses that end them
   pure subroutine make_teeth(kind, e, ft, gf, h, p, exact, overshoot, n, modulus, strength, status)
      integer(c_int), intent(in) :: kind      !! of the list sla_law
      real(wp), intent(in) :: e               !! [Pa]
      real(wp), intent(in) :: ft              !! [Pa]
      real(wp), intent(in) :: gf              !! [N/m]
      real(wp), intent(in) :: h               !! crack band width [m]
      real(wp), intent(in) :: p               !! ripple half-width over ft, 0 < p < 1
      logical, intent(in) :: exact            !! energy-exact teeth, else the ripple
      logical, intent(in) :: overshoot        !! first peak on the upper line, else at ft
      integer(c_int), intent(out) :: n        !! number of teeth
      real(wp), intent(out) :: modulus(:)     !! [Pa]
      real(wp), intent(out) :: strength(:)    !! [Pa]
      integer(c_int), intent(out) :: status   !! status_too_many_steps where the room does not suffice
      type(softening) :: law
      real(wp) :: eps, x, low

      n = 0
      modulus = 0.0_wp
      strength = 0.0_wp
      call softening_new(merge(law_linear, kind, kind == law_yielding), e, ft, gf, h, law, status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if (.not. (p > 0.0_wp .and. p < 1.0_wp)) return
      if (kind == law_yielding) then
         call yielding_teeth(law, p, n, modulus, strength, status)
         return
      end if
      if (exact) then
         call exact_teeth(law, p, overshoot, n, modulus, strength, status)
         return
      end if
      law%clipped = .false.
      status = status_too_many_steps
      modulus(1) = e
      do n = 1, int(size(modulus), c_int)
         if (n == 1 .and. .not. overshoot) then
            strength(1) = ft
            eps = law%peak
            low = ft * (1.0_wp - p)
         else
            x = meets_upper(law, modulus(n), p, law%first())
            eps = law%strain(x)
            strength(n) = modulus(n) * eps
            low = strength(n) - 2.0_wp * p * ft
         end if
         if (low <= least_stress * ft) then
            status = status_ok
            return
         end if
         if (n < size(modulus)) modulus(n + 1) = low / eps
      end do
      n = int(size(modulus), c_int)
   end subroutine make_teeth

   !> Teeth of a plateau at ft that ends at the strain of the energy Gf / h. They end at ft itself, as no more than that
   !> is borne, and begin p / (1 + p) lower than ft (1 - p): on the mean the energy is less by p
   pure subroutine yielding_teeth(law, p, n, modulus, strength, status)
      type(softening), intent(in) :: law       !! the linear one of the same energy
      real(wp), intent(in) :: p
      integer(c_int), intent(out) :: n
      real(wp), intent(inout) :: modulus(:)
      real(wp), intent(inout) :: strength(:)
      integer(c_int), intent(out) :: status
      real(wp) :: last
      status = status_too_many_steps
      last = law%total / law%ft + 0.5_wp * law%peak
      modulus(1) = law%e
      do n = 1, int(size(modulus), c_int)
         strength(n) = min(law%ft, modulus(n) * last)
         if (.not. strength(n) < modulus(n) * last) then
            status = status_ok
            return
         end if
         if (n < size(modulus)) modulus(n + 1) = modulus(n) * (1.0_wp - p) / (1.0_wp + p)
      end do
      n = int(size(modulus), c_int)
   end subroutine yielding_teeth

   !> Teeth that dissipate the energy of the law exactly (our own recipe)
   pure subroutine exact_teeth(law, p, overshoot, n, modulus, strength, status)
      type(softening), intent(in) :: law
      real(wp), intent(in) :: p
      logical, intent(in) :: overshoot
      integer(c_int), intent(out) :: n
      real(wp), intent(inout) :: modulus(:)
      real(wp), intent(inout) :: strength(:)
      integer(c_int), intent(out) :: status
      real(wp) :: x, eps, carry, trial, step, low
      logical :: found
      integer :: k

      status = status_too_many_steps
      n = 1
      modulus(1) = law%e
      x = law%first()
      if (overshoot) x = meets_upper(law, law%e, p, x)
      eps = law%strain(x)
      strength(1) = law%e * eps
      carry = 0.5_wp * law%e * eps**2 - law%energy(x)   ! dissipated too much so far: the next ray pays
      do while (n < size(modulus))
         found = .false.
         if (law%stress(x) > p * law%ft) then
            ! The surplus of a ray over the law rises from `carry`, then falls through zero: the root wanted.
            low = x
            step = 1.0e-3_wp * max(x, law%peak)
            do k = 1, 400
               trial = low + step
               if (surplus(trial) < 0.0_wp) then
                  found = .true.
                  exit
               end if
               if (law%stress(trial) <= 0.0_wp .and. law%kind /= law_exponential) exit
               if (law%stress(trial) <= 1.0e-9_wp * law%ft) exit
               low = trial
               step = 1.05_wp * step
            end do
         end if
         if (found) then
            trial = root(low, trial, .true.)
            ! The linear law ends at zero: what a ray near its foot would leave is a crumb, so it takes all.
            found = law%kind /= law_linear .or. law%stress(trial) > p * law%ft
         end if
         if (.not. found) then
            ! One last ray carries what is left.
            low = x
            trial = 2.0_wp * max(x, law%peak)
            do k = 1, 2000
               if (last(trial) > 0.0_wp) exit
               low = trial
               trial = 1.3_wp * trial
            end do
            trial = root(low, trial, .false.)
         end if
         n = n + 1_c_int
         eps = law%strain(trial)
         strength(n) = law%stress(trial) + p * law%ft
         modulus(n) = strength(n) / eps
         x = trial
         carry = 0.0_wp
         if (.not. found) then
            status = status_ok
            return
         end if
      end do

   contains

      pure function surplus(y) result(s)
         real(wp), intent(in) :: y
         real(wp) :: s, e1, e0
         e0 = law%strain(x)
         e1 = law%strain(y)
         s = 0.5_wp * (law%stress(y) + p * law%ft) * (e1 - e0**2 / e1) - (law%energy(y) - law%energy(x)) + carry
      end function surplus

      pure function last(y) result(s)
         real(wp), intent(in) :: y
         real(wp) :: s, e1, e0
         e0 = law%strain(x)
         e1 = law%strain(y)
         s = 0.5_wp * (law%stress(y) + p * law%ft) * (e1 - e0**2 / e1) - (law%total - law%energy(x)) + carry
      end function last

      pure function root(from, to, falling) result(y)
         real(wp), intent(in) :: from, to
         logical, intent(in) :: falling
         real(wp) :: y, a, b, s
         integer :: j
         a = from
         b = to
         do j = 1, 200
            y = 0.5_wp * (a + b)
            if (y <= a .or. y >= b) exit
            if (falling) then
               s = -surplus(y)
            else
               s = last(y)
            end if
            if (s < 0.0_wp) then
               a = y
            else
               b = y
            end if
         end do
      end function root

   end subroutine exact_teeth

end module sla_sawtooth
